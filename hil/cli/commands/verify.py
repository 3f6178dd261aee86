"""`hil verify`: that report, recording and signature belong together, and that nothing changed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR|REPORT|RECORDING...", help="what belongs together; or a service's folder"
        ),
    ],
    by: Annotated[
        Path | None,
        typer.Option(metavar="PUBLIC_KEY", help="who must have signed the folder: NAME.pub, or PEM"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Prove that reports belong to their recording and that nothing changed; check who signed.

    Of the folder of a bench service (`hil serve --data`) it is the audit log that is read: whether a row was
    changed, put in or taken out.

    A report is held against the recordings that are named, or else against the one beside it. Exit code: 0
    all of it is proven, 1 something does not match or cannot be proven.
    """
    from hil.cli.verify import carry_out

    return carry_out(sources=sources, by=by, as_json=as_json)
