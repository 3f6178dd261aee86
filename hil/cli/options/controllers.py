"""Options of the commands of controllers: design, tune, autotune, campaign."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_bench, shipped_campaign, shipped_model
from hil.cli.options._shared import BenchName, Operator, OverwriteResult, PlanName, found_model


@dataclass(frozen=True, kw_only=True)
class Design:
    """Design a controller for a model: gains, lead or notch, filters, margins, sensitivity."""

    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file of any kind, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    out: Annotated[
        Path | None,
        typer.Option("--out", help="directory for the results; default: out/design-001 and so on"),
    ] = None
    optimize: Annotated[
        bool, typer.Option("--optimize", help="optimise lead and pole for the lowest sensitivity in 8-20 Hz")
    ] = False
    objective: Annotated[str, typer.Option("--objective", help="what --optimize minimises: max or rms")] = (
        "max"
    )
    lead_deg: Annotated[float, typer.Option("--lead-deg", help="phase lead P_h, degrees (equation 6)")] = 36.0
    lead_hz: Annotated[
        float, typer.Option("--lead-hz", help="centre frequency of the lead f_ph, Hz (equation 7)")
    ] = 40.0
    normalisation: Annotated[
        str,
        typer.Option(
            "--normalisation", help="frequency at which the lead has unity gain: dc, centre or high_frequency"
        ),
    ] = "high_frequency"
    notch_hz: Annotated[
        float | None,
        typer.Option(
            "--notch-hz", help="use a notch at this frequency, Hz, instead of the lead (equation 8)"
        ),
    ] = None
    notch_width: Annotated[
        float, typer.Option("--notch-width", help="damping ζ of the notch (equation 8)")
    ] = 2.0
    notch_depth: Annotated[float, typer.Option("--notch-depth", help="depth d of the notch (equation 8)")] = (
        0.08
    )
    pole: Annotated[float, typer.Option("--pole", help="pole p of the observer, rad/s (equations 4, 5)")] = (
        0.3
    )
    inertia: Annotated[
        float | None,
        typer.Option("--inertia", help="J_l/N² + J_m, kg m² (equations 4, 5); default: the model's"),
    ] = None
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", help="gear ratio N of the observer; default: the model's")
    ] = None
    wheel_inertia: Annotated[
        float | None, typer.Option("--wheel-inertia", help="J_l, wheels and dyno rotors, kg m² (equation 9)")
    ] = None
    half_gap: Annotated[
        float | None,
        typer.Option("--half-gap", help="cross a play of this half gap, rad at the wheels ([play])"),
    ] = None
    torque_limit: Annotated[float, typer.Option("--torque-limit", help="largest motor torque, N m")] = 150.0
    largest_sensitivity: Annotated[
        float, typer.Option("--largest-sensitivity", help="upper limit of |S| for --optimize")
    ] = 1.8
    frf: Annotated[
        Path | None, typer.Option("--frf", help="measured responses; default: frf.csv beside the model")
    ] = None
    name: Annotated[str, typer.Option("--name", help="name of the controller")] = ""
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier design in --out")] = False
    json_: Annotated[bool, typer.Option("--json", help="print design.json on stdout, nothing else")] = False


@dataclass(frozen=True, kw_only=True)
class Tune:
    """Optimise a controller's parameters for the largest worst margin over a plan's criteria.

    Each candidate is evaluated by predicted runs of the whole plan, on the nominal model and on vehicles
    sampled around it. Writes controller.toml, free.toml, tune.json, report.html, report.pdf and a figure.
    Ctrl-C ends the search and keeps the best so far.

    --on-bench refines the controller on that bench with at most --runs runs. One consent before the first
    run covers all runs within an envelope. Each run is predicted first and refused if it would leave the
    envelope. bench/ holds the runs; controller.toml is the best one measured. The first run is compared with
    its prediction; if it deviates, diagnosis/ holds the reason. --runs 1 only confirms.

    Exit code: 0 every criterion that depends on the controller and every device check passes (on every
    vehicle; with --on-bench: in the best run, which if it is the first is also as predicted), 1 one does
    not, 3 a run failed.
    """

    SEVERAL = ("--envelope", "--may-worsen")

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
        int | None,
        typer.Option(
            min=1, max=200, help="with --on-bench: largest number of runs; default: 20; 1: only confirm"
        ),
    ] = None
    differ: Annotated[
        float,
        typer.Option(
            metavar="PERCENT",
            min=0.01,
            max=1000,
            help="with --on-bench: deviation of the first run from its prediction, % of a criterion's limit, "
            "above which it is diagnosed",
        ),
    ] = 5.0
    then_run: Annotated[bool, typer.Option("--then-run", hidden=True)] = False
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


@dataclass(frozen=True, kw_only=True)
class Autotune:
    """Identify, diagnose, tune and confirm on a bench, in rounds, unattended.

    A sequence file names the plans and the end conditions. Each round identifies the effects that the model
    lacks and adds them, tunes a controller on the improved model, and confirms and refines it on the bench. A
    run that deviates from its prediction starts another round. The rounds end when prediction and run agree
    and the worst margin no longer grows. One consent before the first run covers all runs within an envelope.

    Writes controller.toml (the best one measured), model.toml, autotune.json with every decision and its
    reason, report.html, report.pdf, and a folder for each stage. Ctrl-C keeps the results so far. Exit code:
    0 prediction and run agree and every criterion that depends on the controller passes, 1 otherwise, 3 a run
    failed.
    """

    SEVERAL = ("--envelope",)

    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="initial model file of the axle (a chain), or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    sequence: Annotated[str, typer.Argument(help="sequence file, or the name of a shipped one: autotune")] = (
        "autotune"
    )
    bench: BenchName = ""
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/autotune-NNN")] = (
        None
    )
    envelope: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CHANNEL=VALUE",
            help="largest magnitude allowed in a run, or bench_time_s for all runs; default: 1.3 times "
            "the values predicted for both plans",
        ),
    ] = None
    confirm: Annotated[
        str,
        typer.Option(metavar="NAME", help="name of the person who authorises all runs within the envelope"),
    ] = ""
    operator: Operator = ""
    processes: Annotated[
        int | None, typer.Option(min=1, max=256, help="parallel predictions; default: one per core")
    ] = None
    resume: Annotated[
        bool,
        typer.Option("--resume", help="continue in --out; keep the runs made there before the first round"),
    ] = False
    overwrite: OverwriteResult = False
    json_: Annotated[bool, typer.Option("--json", help="print autotune.json on stdout, nothing else")] = False


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """Simulate a plan many times: vary parameters, sample vehicles around the model, compare controllers.

    Writes simulations/ (Parquet, one row per simulation), campaign.json, report.html and report.pdf. Ctrl-C
    waits a few seconds for simulations under way and keeps them; a second Ctrl-C does not wait. --resume
    continues, also after a kill of this command, of a worker or of the scheduler. No simulation is lost or
    stored twice.

    Exit code: 0 done, each controller reaches the file's pass_share, 1 one does not, 3 no worker could
    continue; finished simulations are kept.
    """

    campaign: Annotated[
        str,
        typer.Argument(
            help="campaign file, or the name of a shipped one: robustness", autocompletion=shipped_campaign()
        ),
    ]
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/campaign-NNN")] = (
        None
    )
    workers: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=1024,
            help="worker processes on this machine; 0: none, simulate in this process; default: one per core",
        ),
    ] = None
    scheduler: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="address of a dask.distributed scheduler; use its workers instead"
        ),
    ] = ""
    server: Annotated[
        str,
        typer.Option(metavar="URL", help="run it on a bench service (hil serve); HIL_TOKEN holds the token"),
    ] = ""
    resume: Annotated[
        bool, typer.Option("--resume", help="continue in --out; simulate only what is missing")
    ] = False
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="print the number of simulations and the duration; write nothing"),
    ] = False
    overwrite: OverwriteResult = False
    json_: Annotated[bool, typer.Option("--json", help="print campaign.json on stdout, nothing else")] = False
