"""`hil autotune`: identify, diagnose, add, tune, confirm, and again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_model
from hil.cli.options._shared import BenchName, Operator, OverwriteResult, found_model

SEVERAL = ("--envelope",)


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
