"""`hil simulate`: what a model says to a recording's torque."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli.commands._options import ModelOption


def command(
    model: ModelOption,
    source: Annotated[Path, typer.Option("--input", help="recording with motor_torque_ref_nm")],
    out: Annotated[Path, typer.Option(help="file to write: .csv, .parquet, .mf4 or .mat")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the file in --out")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Replay a recording's motor_torque_ref_nm through a model, from the recording's initial speeds.

    The model's outputs are written at the recording's time stamps.
    """
    from hil.cli.simulate import carry_out

    return carry_out(model=model, source=source, out=out, overwrite=overwrite, as_json=as_json)
