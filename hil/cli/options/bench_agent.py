"""`hil bench agent`: benches of this machine for a bench service elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

SEVERAL = ("--bench", "--server")


@dataclass(frozen=True, kw_only=True)
class BenchAgent:
    """Drive benches of this machine for a bench service on another machine.

    The service holds the queue and the page. The agent works until Ctrl-C or SIGTERM; it then ends runs
    under way with their end steps. When the service is out of reach, a run continues and is uploaded later.
    HIL_TOKEN holds a token with the role agent. Exit code: 0 the time of --for is over, 2 bad input, 3 the
    service has another bench of that name, 130 ended by a signal.
    """

    server: Annotated[
        list[str],
        typer.Option(
            metavar="URL", help="address of the service; repeat it for several services with one database"
        ),
    ]
    data: Annotated[
        Path, typer.Option(metavar="DIR", help="directory that keeps runs until the service has them")
    ]
    bench: Annotated[
        list[str] | None, typer.Option(help="bench files, or names of shipped benches; default: sim")
    ] = None
    name: Annotated[
        str, typer.Option(help="name of this agent in the service; default: this machine's name")
    ] = ""
    keep_local: Annotated[
        float,
        typer.Option(
            min=0, metavar="DAYS", help="days to keep files in DIR after their upload to the service"
        ),
    ] = 30.0
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )
