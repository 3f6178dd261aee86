"""`hil identify`: from recordings to frequency responses, transfer functions and a driveline chain."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.commands._options import Columns


@dataclass(frozen=True, kw_only=True)
class Identify:
    """Identify frequency responses, transfer functions with dead time, and the driveline chain."""

    recordings: Annotated[
        list[Path], typer.Argument(help="recordings (.mcap, .csv, .parquet, .mf4, .mat); several are merged")
    ]
    out: Annotated[
        Path | None,
        typer.Option("--out", help="directory for the results; default: out/identify-001 and so on"),
    ] = None
    segments: Annotated[
        list[str] | None,
        typer.Option("--segment", help="id of a segment to use; default: every chirp and multisine"),
    ] = None
    input_channel: Annotated[str, typer.Option("--input", help="excitation channel")] = "motor_torque_ref_nm"
    from_hz: Annotated[
        float | None,
        typer.Option(
            "--from-hz", min=1e-4, help="lowest frequency, Hz; default: 0.05 or the lowest one excited"
        ),
    ] = None
    to_hz: Annotated[
        float | None,
        typer.Option(
            "--to-hz", min=1e-3, help="highest frequency, Hz; default: 30 or the highest one excited"
        ),
    ] = None
    order: Annotated[
        int | None,
        typer.Option("--order", min=2, max=7, help="order of the denominator; default: chosen from the data"),
    ] = None
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", min=1e-3, help="known gear ratio of the chain")
    ] = None
    method: Annotated[str, typer.Option("--method", help="auto, lpm, periodic, h1, h2 or hv")] = "auto"
    hold_ms: Annotated[
        float | None,
        typer.Option(
            "--hold-ms",
            min=0.0,
            help="zero-order hold of the input, ms; default: the sample time, at most 1 ms",
        ),
    ] = None
    columns: Columns = None
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace an earlier identification in --out")
    ] = False
    json_: Annotated[
        bool, typer.Option("--json", help="print identification.json on stdout, nothing else")
    ] = False

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        from hil.cli.identify import carry_out

        return carry_out(self)
