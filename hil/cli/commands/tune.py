"""`hil tune`: from a plan's criteria to a controller."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._lean_imports import import_python_can
from hil.cli.commands._options import Operator, PlanName, SimulatedBenchName


def command(
    plan: PlanName,
    model: Annotated[
        Path, typer.Option("--model", help="model file of the axle (a chain), effects included")
    ],
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/tune-NNN")] = None,
    free: Annotated[
        Path | None,
        typer.Option(help="what is free, weights, hard limits, tolerances (TOML); default: as shipped"),
    ] = None,
    controller: Annotated[
        str,
        typer.Option(help="which of the plan's controllers is tuned, by its file's name; default: the last"),
    ] = "",
    start: Annotated[
        Path | None, typer.Option(help="controller file to begin with; default: the plan's own")
    ] = None,
    draws: Annotated[
        int,
        typer.Option(min=0, max=5000, help="cars drawn from uncertainty and tolerances; 0: the model alone"),
    ] = 0,
    seed: Annotated[int, typer.Option(min=0, help="of draws and search")] = 0,
    generations: Annotated[
        int, typer.Option(min=1, max=1000, help="of the search over the whole space, on the model itself")
    ] = 20,
    at_most: Annotated[
        float | None,
        typer.Option(metavar="MINUTES", min=0.01, help="end the search then, with the best so far"),
    ] = None,
    processes: Annotated[
        int | None, typer.Option(min=1, max=256, help="predictions at once; default: one for each core")
    ] = None,
    bench: SimulatedBenchName = "sim",
    then_run: Annotated[
        bool,
        typer.Option("--then-run", help="run the plan with it on the bench at once; beside the prediction"),
    ] = False,
    differ: Annotated[
        float,
        typer.Option(
            metavar="PERCENT",
            min=0.01,
            max=1000,
            help="of a criterion's limit: a run that differs by more from its prediction is diagnosed",
        ),
    ] = 5.0,
    operator: Operator = "",
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace an earlier result in --out")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="print tune.json on stdout, nothing else")] = False,
) -> int:
    """Search a controller's parameters for the largest worst margin over a plan's criteria.

    Every candidate is a whole predicted run of the plan, on the model and on cars drawn around it. Writes
    controller.toml, free.toml, tune.json, report.html, report.pdf and a figure. Ctrl-C ends the search and
    keeps the best so far. With --then-run the plan is run with it on the bench at once: run/ has the run, and
    where it is not as predicted diagnosis/ says why. Exit code: 0 every criterion that depends on the
    controller passes (on every car; with --then-run: in the run, and as predicted), 1 one does not.
    """
    import_python_can()
    from hil.cli.tune import carry_out

    return carry_out(
        plan=plan,
        model=model,
        out=out,
        free=free,
        controller=controller,
        start=start,
        draws=draws,
        seed=seed,
        generations=generations,
        at_most=at_most,
        processes=processes,
        bench=bench,
        then_run=then_run,
        differ=differ,
        operator=operator,
        overwrite=overwrite,
        json_=json_,
    )
