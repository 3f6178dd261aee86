"""`hil serve`: the bench service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._lean_imports import import_python_can

SEVERAL = ("--bench", "--allow-host", "--trusted-proxy")


def command(
    data: Annotated[Path, typer.Option(metavar="DIR", help="where runs, plans and the database are kept")],
    bench: Annotated[
        list[str] | None, typer.Option(help="bench files, or names of shipped benches; default: sim")
    ] = None,
    no_bench: Annotated[
        bool, typer.Option("--no-bench", help="serve no bench of this machine, only those of agents")
    ] = False,
    host: Annotated[
        str, typer.Option(help="address to listen at; another than this machine's needs tokens")
    ] = ("127.0.0.1"),
    port: Annotated[int, typer.Option(min=0, max=65535, help="port; 0 takes a free one")] = 8080,
    stop_port: Annotated[
        int | None,
        typer.Option(
            min=0, max=65535, help="port of the stop post; default: the one after --port; 0 takes a free one"
        ),
    ] = None,
    stop_url: Annotated[
        str,
        typer.Option(metavar="URL", help="where browsers reach the stop post, if a proxy stands before it"),
    ] = "",
    trusted_proxy: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ADDRESS",
            help="a proxy before the service: who asks, and whether by TLS, is what it says",
        ),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="further names by which browsers may call the service"),
    ] = None,
    database: Annotated[
        str,
        typer.Option(
            metavar="URL",
            envvar="HIL_DATABASE",
            help="in place of SQLite in DIR: postgresql://user@host/name",
        ),
    ] = "",
    store: Annotated[
        str,
        typer.Option(
            metavar="URL",
            help="keep files of runs there, too: s3://bucket/prefix, or a folder of another disk",
        ),
    ] = "",
    keep_local: Annotated[
        float,
        typer.Option(min=0, metavar="DAYS", help="how long files stay in DIR that the store has"),
    ] = 30.0,
    workers: Annotated[
        int | None,
        typer.Option(
            min=0, max=1024, help="processes that simulate campaigns; default: all processors but one"
        ),
    ] = None,
    scheduler: Annotated[
        str,
        typer.Option(metavar="ADDRESS", help="of dask.distributed, whose workers simulate in their place"),
    ] = "",
    rate: Annotated[
        float,
        typer.Option(
            min=1, metavar="N", help="requests that an address may send a second; behind a proxy all have one"
        ),
    ] = 40.0,
    for_s: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", help="end by itself after this time")
    ] = None,
    add_token: Annotated[
        str,
        typer.Option(
            metavar="NAME=ROLE",
            help="make a token, print it, and end; roles: viewer, operator, engineer, admin, agent",
        ),
    ] = "",
    token_days: Annotated[
        float, typer.Option(min=0.01, max=3650, metavar="DAYS", help="how long that token is valid")
    ] = 365.0,
    as_json: Annotated[
        bool, typer.Option("--json", help="print one JSON object on stdout, nothing else there")
    ] = False,
) -> int:
    """Make benches a shared instrument: a queue of runs, an API, a page that shows what they do.

    Serves until Ctrl-C or SIGTERM; runs under way are ended then, with their end steps. Without tokens it
    listens to this machine only. Exit code: 2 bad input, 3 the port is taken or the database cannot be used,
    130 ended by a signal; 0 its time (--for) is over.
    """
    import_python_can()
    from hil.cli.serve import carry_out

    return carry_out(
        data=data, bench=bench or [], no_bench=no_bench, host=host, port=port,
        stop_port=stop_port, stop_url=stop_url, trusted_proxy=trusted_proxy or [],
        allow_host=allow_host or [],
        database=database, store=store, keep_local=keep_local, workers=workers, scheduler=scheduler,
        rate=rate, for_s=for_s, add_token=add_token, token_days=token_days, as_json=as_json,
    )  # fmt: skip
