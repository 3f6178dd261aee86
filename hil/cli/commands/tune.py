"""`hil tune`: from a plan's criteria to a controller."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.app.worker.lean_imports import import_python_can
from hil.cli._completion import shipped_bench, shipped_model
from hil.cli.commands._options import Operator, OverwriteResult, PlanName, found_model

SEVERAL = ("--envelope", "--may-worsen")


@dataclass(frozen=True, kw_only=True)
class Tune:
    """Optimise a controller's parameters for the largest worst margin over a plan's criteria.

    Each candidate is evaluated by predicted runs of the whole plan, on the nominal model and on vehicles
    sampled around it. Writes controller.toml, free.toml, tune.json, report.html, report.pdf and a figure.
    Ctrl-C ends the search and keeps the best so far.

    --then-run then runs the plan with the tuned controller: run/ holds the run. If it deviates from the
    prediction, diagnosis/ holds the reason.

    --on-bench refines the controller on that bench with at most --runs runs. One consent before the first
    run covers all runs within an envelope. Each run is predicted first and refused if it would leave the
    envelope. bench/ holds the runs; controller.toml is the best one measured.

    Exit code: 0 every criterion that depends on the controller passes (on every vehicle; with --then-run: in
    the run, and as predicted; with --on-bench: in the best run), 1 one does not, 3 a run failed.
    """

    plan: PlanName
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file of the axle (a chain), effects included, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/tune-NNN")] = None
    free: Annotated[
        Path | None,
        typer.Option(
            help="TOML with free parameters, weights, hard limits and tolerances; default: the built-in one"
        ),
    ] = None
    controller: Annotated[
        str,
        typer.Option(help="file name of the plan's controller to tune; default: the last one"),
    ] = ""
    start: Annotated[Path | None, typer.Option(help="initial controller file; default: the plan's")] = None
    draws: Annotated[
        int,
        typer.Option(
            min=0,
            max=5000,
            help="vehicles sampled from uncertainty and tolerances; 0: the nominal model only",
        ),
    ] = 0
    seed: Annotated[int, typer.Option(min=0, help="random seed of sampling and search")] = 0
    may_worsen: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="let this get worse than with the initial controller by more than 5 %: response_time, "
            "steady_error, torque_effort, stability, criteria",
        ),
    ] = None
    starts: Annotated[
        int,
        typer.Option(min=0, max=1000, help="number of additional starting points of the optimiser"),
    ] = 6
    at_most: Annotated[
        float | None,
        typer.Option(
            metavar="MINUTES", min=0.01, help="stop the search after this time; keep the best so far"
        ),
    ] = None
    processes: Annotated[
        int | None, typer.Option(min=1, max=256, help="parallel predictions; default: one per core")
    ] = None
    bench: Annotated[
        str,
        typer.Option(
            help="simulated bench to predict on, by file or name; default: that of --on-bench, else as of "
            "`hil run`",
            autocompletion=shipped_bench(),
        ),
    ] = ""
    then_run: Annotated[
        bool,
        typer.Option(
            "--then-run", help="then run the plan with the tuned controller; compare with the prediction"
        ),
    ] = False
    differ: Annotated[
        float,
        typer.Option(
            metavar="PERCENT",
            min=0.01,
            max=1000,
            help="deviation from the prediction, % of a criterion's limit, above which a run is diagnosed",
        ),
    ] = 5.0
    on_bench: Annotated[
        str,
        typer.Option(
            "--on-bench",
            metavar="BENCH",
            help="refine the controller by runs on BENCH, within a trust region around the prediction",
            autocompletion=shipped_bench(),
        ),
    ] = ""
    runs: Annotated[
        int | None, typer.Option(min=1, max=200, help="with --on-bench: largest number of runs; default: 20")
    ] = None
    envelope: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CHANNEL=VALUE",
            help="with --on-bench: largest magnitude allowed in a run, or bench_time_s for all runs; "
            "default: 1.3 times the values predicted for the plan",
        ),
    ] = None
    confirm: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="with --on-bench: name of the person who authorises all runs within the envelope",
        ),
    ] = ""
    operator: Operator = ""
    overwrite: OverwriteResult = False
    json_: Annotated[bool, typer.Option("--json", help="print tune.json on stdout, nothing else")] = False

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        import_python_can()
        from hil.cli.tune import carry_out

        return carry_out(self)
