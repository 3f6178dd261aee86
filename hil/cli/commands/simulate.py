"""`hil simulate`: what a model says to a recording's torque."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.commands._options import Columns, JsonObject, ModelOption, OverwriteFile


@dataclass(frozen=True, kw_only=True)
class Simulate:
    """Replay a recording's motor_torque_ref_nm through a model, from the recording's initial speeds.

    The model's outputs are written at the recording's time stamps.
    """

    model: ModelOption
    source: Annotated[Path, typer.Option("--input", help="recording with motor_torque_ref_nm")]
    out: Annotated[Path, typer.Option(help="file to write: .csv, .parquet, .mf4 or .mat")]
    columns: Columns = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        from hil.cli.simulate import carry_out

        return carry_out(self)
