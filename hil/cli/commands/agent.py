"""`hil agent`: benches of this machine for a bench service elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._lean_imports import import_python_can

SEVERAL = ("--bench", "--server")


def command(
    server: Annotated[
        list[str],
        typer.Option(metavar="URL", help="the service, or several with one database"),
    ],
    data: Annotated[Path, typer.Option(metavar="DIR", help="where runs are kept until the service has them")],
    bench: Annotated[
        list[str] | None, typer.Option(help="bench files, or names of shipped benches; default: sim")
    ] = None,
    name: Annotated[str, typer.Option(help="what people call this agent; default: this machine's name")] = "",
    keep_local: Annotated[
        float,
        typer.Option(min=0, metavar="DAYS", help="how long files stay in DIR that the service has"),
    ] = 30.0,
    for_s: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", help="end by itself after this time")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="print one JSON object on stdout, nothing else there")
    ] = False,
) -> int:
    """Drive benches of this machine for a bench service elsewhere, which has their queue and their page.

    Works until Ctrl-C or SIGTERM; runs under way are ended then, with their end steps. While the service is
    away a run goes on, and is delivered later. HIL_TOKEN is a token with the role agent. Exit code: 2 bad
    input, 3 a bench's name is another's there, 130 ended by a signal; 0 its time (--for) is over.
    """
    import_python_can()
    from hil.cli.agent import carry_out

    return carry_out(
        server=server, data=data, bench=bench or ["sim"], name=name, keep_local=keep_local, for_s=for_s,
        as_json=as_json,
    )  # fmt: skip
