"""`hil export`: a recording or a model for other tools."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.commands._options import Columns, JsonObject, OverwriteFile


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write a recording's channels as CSV, Parquet, MDF4 or MAT, or its frames as BLF, ASC, candump or MDF4.

    With --inputs: the files with which the run can be carried out again. What was lost is said.

    A model, with its controller, is written as an FMI 2 co-simulation unit (FMU). The unit computes with this
    package: where it is used, Python with eaxle-hil has to be installed.
    """

    recording: Annotated[
        Path,
        typer.Argument(
            metavar="SOURCE",
            help="recording (.mcap, .csv, .parquet, .mf4, .mat); for an FMU, a model by file or name",
        ),
    ]
    out: Annotated[
        Path,
        typer.Option(
            help="file to write: .csv, .parquet, .mf4 or .mat; raw frames: .blf, .asc or .log (candump); "
            "a model: .fmu"
        ),
    ]
    controller: Annotated[
        Path | None,
        typer.Option(help="controller file for an FMU; without it the FMU's input is motor torque"),
    ] = None
    frames: Annotated[
        bool, typer.Option("--frames", help="write raw frames, not channels, to .mf4 (ASAM bus logging)")
    ] = False
    inputs: Annotated[
        bool,
        typer.Option(
            "--inputs", help="write plan, bench, model and controllers of the run to the folder --out"
        ),
    ] = False
    columns: Columns = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        from hil.cli.export import carry_out

        return carry_out(self)
