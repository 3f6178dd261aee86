"""`hil bench monitor`: channels and bus load live, touching nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from hil.cli.options._shared import BenchArgument


@dataclass(frozen=True, kw_only=True)
class BenchMonitor:
    """Show decoded channels and bus load live; no frame is sent, not even a heartbeat.

    Prints a table that updates on a terminal, else a line per update. Exit code: 0 the time of --for is over,
    2 bad input or a simulated bench, 3 no bus can be opened or one fails, 130 ended by Ctrl-C.
    """

    bench: BenchArgument
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    every_s: Annotated[
        float | None,
        typer.Option(
            "--every", metavar="SECONDS", help="time between two updates; default: 0.2 on a terminal, else 1"
        ),
    ] = None
    as_json: Annotated[
        bool,
        typer.Option("--json", help="print one JSON object for the whole time, nothing else"),
    ] = False
