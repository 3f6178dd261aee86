"""`hil autotune`: identify, diagnose, add, tune, confirm, and again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_model
from hil.cli._lean_imports import import_python_can
from hil.cli.commands._options import BenchName, Operator, found_model

SEVERAL = ("--envelope",)


def command(
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file of the axle (a chain) to begin with, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ],
    sequence: Annotated[
        str, typer.Argument(help="sequence file, or the name of a shipped one: autotune")
    ] = "autotune",
    bench: BenchName = "",
    out: Annotated[
        Path | None, typer.Option(help="directory for the results; default: out/autotune-NNN")
    ] = None,
    envelope: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CHANNEL=VALUE",
            help="largest magnitude that a run may reach, or bench_time_s for all of them; default: 1.3 "
            "times what is predicted of both plans as they are",
        ),
    ] = None,
    confirm: Annotated[
        str, typer.Option(metavar="NAME", help="who takes all runs upon them, within the envelope")
    ] = "",
    operator: Operator = "",
    processes: Annotated[
        int | None, typer.Option(min=1, max=256, help="predictions at once; default: one for each core")
    ] = None,
    resume: Annotated[
        bool,
        typer.Option("--resume", help="go on in --out: what was run there before the first round is kept"),
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace an earlier result in --out")
    ] = False,
    json_: Annotated[
        bool, typer.Option("--json", help="print autotune.json on stdout, nothing else")
    ] = False,
) -> int:
    """Identify, diagnose, add, tune, confirm on a bench, and again, unattended.

    A sequence file names the plans and says when it is enough. What the model lacks is named from recordings
    and added; a controller is tuned on the better model, confirmed and refined on the bench; a run that is
    not as predicted is explained in another round. It ends when prediction and run agree and the worst margin
    no longer grows. One consent before the first run stands for all of them, within an envelope.

    Writes controller.toml (the best that was measured), model.toml, autotune.json with every decision and its
    reason, report.html, report.pdf, and a folder for each stage. Ctrl-C keeps what is known. Exit code: 0
    prediction and run agree and every criterion that depends on the controller passes, 1 not so, 3 a run
    failed.
    """
    import_python_can()
    from hil.cli.autotune import carry_out

    return carry_out(
        sequence=sequence,
        model=model,
        bench=bench,
        out=out,
        envelope=envelope,
        confirm=confirm,
        operator=operator,
        processes=processes,
        resume=resume,
        overwrite=overwrite,
        json_=json_,
    )
