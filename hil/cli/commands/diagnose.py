"""`hil diagnose`: why recordings and a model differ, the missing effect, and the better model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_model
from hil.cli.commands._options import Columns, found_model

#: Options that take several values.
SEVERAL = ("--holdout",)


@dataclass(frozen=True, kw_only=True)
class Diagnose:
    """Find where a model and recordings disagree, identify the missing effect and add it to the model.

    Writes model.toml, diagnosis.json, report.html and report.pdf, all or none.
    """

    recordings: Annotated[
        list[Path], typer.Argument(help="recordings to explain (.mcap, .csv, .parquet, .mf4, .mat)")
    ]
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file to start from, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    out: Annotated[
        Path | None,
        typer.Option("--out", help="directory for the results; default: out/diagnose-001 and so on"),
    ] = None
    holdout: Annotated[
        list[Path] | None,
        typer.Option(
            "--holdout",
            help="recordings for validation, not used in any fit; all files up to the next option",
        ),
    ] = None
    noise: Annotated[
        list[str] | None,
        typer.Option(
            "--noise",
            metavar="CHANNEL=VALUE",
            help="standard deviation of a channel's samples, from its sensor's data sheet; repeatable",
        ),
    ] = None
    least: Annotated[
        list[str] | None,
        typer.Option(
            "--least",
            metavar="EFFECT=SIZE",
            help="smallest relevant size of an effect, in its own unit; repeatable",
        ),
    ] = None
    at_most: Annotated[
        float,
        typer.Option(
            "--at-most",
            metavar="MINUTES",
            help="processor time of the search; then the result so far is reported as unfinished",
        ),
    ] = 10.0
    columns: Columns = None
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier diagnosis in --out")] = (
        False
    )
    json_: Annotated[bool, typer.Option("--json", help="print diagnosis.json on stdout, nothing else")] = (
        False
    )

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        from hil.cli.diagnose import carry_out

        return carry_out(self)
