"""`hil tune`: from a plan's criteria to a controller."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_bench, shipped_model
from hil.cli._lean_imports import import_python_can
from hil.cli.commands._options import Operator, PlanName, found_model

SEVERAL = ("--envelope",)


def command(
    plan: PlanName,
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file of the axle (a chain), effects included, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
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
    starts: Annotated[
        int,
        typer.Option(
            min=0, max=1000, help="points from which it goes uphill on the model itself, beside the start"
        ),
    ] = 6,
    at_most: Annotated[
        float | None,
        typer.Option(metavar="MINUTES", min=0.01, help="end the search then, with the best so far"),
    ] = None,
    processes: Annotated[
        int | None, typer.Option(min=1, max=256, help="predictions at once; default: one for each core")
    ] = None,
    bench: Annotated[
        str,
        typer.Option(
            help="simulated bench to predict on, by file or name; default: that of --on-bench, else as of "
            "`hil run`",
            autocompletion=shipped_bench(),
        ),
    ] = "",
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
    on_bench: Annotated[
        str,
        typer.Option(
            "--on-bench",
            metavar="BENCH",
            help="refine there by runs of the plan, within a trust region around the prediction",
            autocompletion=shipped_bench(),
        ),
    ] = "",
    runs: Annotated[
        int | None, typer.Option(min=1, max=200, help="with --on-bench: at most so many; default: 20")
    ] = None,
    envelope: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CHANNEL=VALUE",
            help="with --on-bench: largest magnitude that a run may reach, or bench_time_s for all of them; "
            "default: 1.3 times what is predicted of the plan as it is",
        ),
    ] = None,
    confirm: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="with --on-bench: who takes all its runs upon them, within the envelope"
        ),
    ] = "",
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
    controller passes (on every car; with --then-run: in the run, and as predicted; with --on-bench: in the
    best run), 1 one does not, 3 a run failed.

    With --on-bench the controller is refined on that bench: at most --runs runs of the plan, one consent
    before the first for all of them within an envelope, each predicted first and refused beyond it; bench/
    has the runs, controller.toml the best that was measured.
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
        starts=starts,
        at_most=at_most,
        processes=processes,
        bench=bench,
        then_run=then_run,
        differ=differ,
        on_bench=on_bench,
        runs=runs,
        envelope=envelope,
        confirm=confirm,
        operator=operator,
        overwrite=overwrite,
        json_=json_,
    )
