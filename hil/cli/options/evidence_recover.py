"""`hil evidence recover`: a whole recording from what a crash left."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.options._shared import JsonObject, OverwriteFile


@dataclass(frozen=True, kw_only=True)
class EvidenceRecover:
    """Recover a recording after a crash, a power cut or a disk fault, and list what is missing.

    The input is never written over. A recording that is whole is left as it is. `hil report` makes the report
    of the recovered recording; it says that the run was cut.
    """

    source: Annotated[
        Path, typer.Argument(metavar="RECORDING_OR_DIR", help="a recording (.mcap), or a run's directory")
    ]
    out: Annotated[
        Path | None, typer.Option(help="file to write: .mcap; default: NAME.recovered.mcap beside it")
    ] = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False
