"""`hil serve`: the bench service."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

SEVERAL = ("--bench", "--allow-host", "--trusted-proxy")


@dataclass(frozen=True, kw_only=True)
class Serve:
    """Run the bench service, which shares benches: a run queue, a REST API and a live page.

    Serves until Ctrl-C or SIGTERM; it then ends runs under way with their end steps. Without tokens it
    accepts connections from this machine only. Exit code: 0 the time of --for is over, 2 bad input, 3 the
    port is in use or the database cannot be used, 130 ended by a signal.
    """

    data: Annotated[Path, typer.Option(metavar="DIR", help="directory for runs, plans and the database")]
    bench: Annotated[
        list[str] | None, typer.Option(help="bench files, or names of shipped benches; default: sim")
    ] = None
    no_bench: Annotated[
        bool, typer.Option("--no-bench", help="serve only benches of agents, none of this machine")
    ] = False
    host: Annotated[
        str, typer.Option(help="address to listen on; any other than the loopback needs tokens")
    ] = "127.0.0.1"
    port: Annotated[int, typer.Option(min=0, max=65535, help="port; 0 takes a free one")] = 8080
    stop_port: Annotated[
        int | None,
        typer.Option(
            min=0, max=65535, help="port of the stop post; default: the one after --port; 0 takes a free one"
        ),
    ] = None
    stop_url: Annotated[
        str,
        typer.Option(metavar="URL", help="address of the stop post for browsers, if it is behind a proxy"),
    ] = ""
    trusted_proxy: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ADDRESS",
            help="address of a proxy whose headers for client address and TLS are trusted",
        ),
    ] = None
    allow_host: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="additional host name that browsers may use for the service"),
    ] = None
    database: Annotated[
        str,
        typer.Option(
            metavar="URL",
            envvar="HIL_DATABASE",
            help="database instead of SQLite in DIR: postgresql://user@host/name",
        ),
    ] = ""
    store: Annotated[
        str,
        typer.Option(
            metavar="URL",
            help="second place for files of runs: s3://bucket/prefix, or a folder on another disk",
        ),
    ] = ""
    keep_local: Annotated[
        float,
        typer.Option(min=0, metavar="DAYS", help="days to keep files in DIR after they are in the store"),
    ] = 30.0
    workers: Annotated[
        int | None,
        typer.Option(min=0, max=1024, help="worker processes for campaigns; default: all processors but one"),
    ] = None
    scheduler: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="address of a dask.distributed scheduler; use its workers instead"
        ),
    ] = ""
    rate: Annotated[
        float,
        typer.Option(
            min=1,
            metavar="N",
            help="requests per second allowed for a client address; a proxy counts as one client",
        ),
    ] = 40.0
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    add_token: Annotated[
        str,
        typer.Option(
            metavar="NAME=ROLE",
            help="make a token, print it and exit; roles: viewer, operator, engineer, admin, agent",
        ),
    ] = ""
    token_days: Annotated[
        float, typer.Option(min=0.01, max=3650, metavar="DAYS", help="validity of that token, days")
    ] = 365.0
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )
