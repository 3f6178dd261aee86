"""`hil doctor`: what of a bench is there, what is wrong with it, and what to do."""

from __future__ import annotations

from typing import Annotated

import typer

from hil.cli._lean_imports import import_python_can
from hil.cli.commands._options import DefaultBenchArgument


def command(
    bench: DefaultBenchArgument = "",
    for_s: Annotated[
        float, typer.Option("--for", metavar="SECONDS", help="how long to listen before anybody is asked")
    ] = 2.0,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Find out what is connected, what answers, and what is wrong, with what to do about it.

    Listens first, then reads from every device; writes nothing, moves nothing. Exit code: 0 no fault (hints
    change nothing), 1 faults were found, 2 the bench file cannot be used, 3 neither RMCU nor dynos answer.
    """
    import_python_can()
    from hil.cli.doctor import carry_out

    return carry_out(bench=bench, for_s=for_s, as_json=as_json)
