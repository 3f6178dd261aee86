"""`hil export-fmu`: a model with its controller for other simulation tools."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_model
from hil.cli.commands._options import JsonObject, OverwriteFile, found_model


@dataclass(frozen=True, kw_only=True)
class ExportFmu:
    """Export a model, with its controller, as an FMI 2 co-simulation unit (FMU).

    The unit computes with this package: where it is used, Python with eaxle-hil has to be installed.
    """

    model: Annotated[
        Path,
        typer.Argument(
            help="model file, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    out: Annotated[Path, typer.Option(help="FMU to write: NAME.fmu")]
    controller: Annotated[
        Path | None, typer.Option(help="controller file; without it the FMU's input is motor torque")
    ] = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        from hil.cli.export_fmu import carry_out

        return carry_out(self)
