"""`hil diagnose`: why recordings and a model differ, the missing effect, and the better model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_model
from hil.cli.commands._options import found_model

#: Options that take several values.
SEVERAL = ("--holdout",)


def command(
    recordings: Annotated[
        list[Path], typer.Argument(help="Recordings to explain (.mcap, .csv, .parquet, .mf4, .mat).")
    ],
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="Model file to start from, or the name of a shipped model.",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Directory for the results; default: out/diagnose-001 and so on."),
    ] = None,
    holdout: Annotated[
        list[Path] | None,
        typer.Option(
            "--holdout",
            help="Recordings that no fit sees, only the final figures: all files up to the next option.",
        ),
    ] = None,
    noise: Annotated[
        list[str] | None,
        typer.Option(
            "--noise",
            metavar="CHANNEL=VALUE",
            help="Standard deviation of a sample of a channel, as its sensor's data sheet says; repeatable.",
        ),
    ] = None,
    least: Annotated[
        list[str] | None,
        typer.Option(
            "--least",
            metavar="EFFECT=SIZE",
            help="Smallest size of an effect that is worth a name, in its own unit; repeatable.",
        ),
    ] = None,
    at_most: Annotated[
        float,
        typer.Option(
            "--at-most",
            metavar="MINUTES",
            help="Processor time of the search; then what is known so far is told, as unfinished.",
        ),
    ] = 10.0,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an earlier diagnosis in --out.")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print diagnosis.json and nothing else.")] = False,
) -> int:
    """Find where a model and recordings disagree, name the missing effect, add it to the model.

    Writes model.toml, diagnosis.json, report.html and report.pdf, all or none.
    """
    from hil.cli.diagnose import carry_out

    return carry_out(
        recordings=recordings,
        model=model,
        out=out,
        holdout=holdout,
        noise=noise,
        least=least,
        at_most=at_most,
        overwrite=overwrite,
        json_=json_,
    )
