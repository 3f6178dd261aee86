"""`hil bench reset`: a bench may be armed again after an emergency stop."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.options._shared import BenchArgument, JsonObject


@dataclass(frozen=True, kw_only=True)
class BenchReset:
    """Reset an emergency stop, so that the bench can be armed again. Nothing moves.

    First make sure that no one is in danger and that the cause of the stop is removed.
    """

    bench: BenchArgument
    by: Annotated[
        str,
        typer.Option(
            "--by", metavar="NAME", help="name of the person who checked that it is safe; kept in the record"
        ),
    ]
    data: Annotated[
        Path | None,
        typer.Option(
            "--data",
            metavar="DIR",
            help="data directory of the service or agent that drives this simulated bench",
        ),
    ] = None
    as_json: JsonObject = False
