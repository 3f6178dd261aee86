"""`hil bench jog`: turns the axle a little and checks every sign."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.options._shared import BenchArgument


@dataclass(frozen=True, kw_only=True)
class BenchJog:
    """Turn the axle at low torque and check the sign of every torque and speed.

    The axle moves: an operator is asked before, and whether the wheels turned forwards. Exit code: 0 every
    sign is right, 1 one is wrong or was not seen, 2 bad input, 3 the bench failed, 130 interrupted.
    """

    bench: BenchArgument
    torque: Annotated[float, typer.Option(metavar="NM", help="motor torque, N m")] = 10.0
    out: Annotated[
        Path | None,
        typer.Option(help="directory for recording and jog.json; default: out/jog-001 and so on"),
    ] = None
    operator: Annotated[str, typer.Option(help="name of the person who runs the bench")] = ""
    yes: Annotated[
        str,
        typer.Option(
            "--yes", metavar="NAME", help="name of the person who confirms all operator prompts in advance"
        ),
    ] = ""
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier jog in --out")] = False
    as_json: Annotated[bool, typer.Option("--json", help="print jog.json on stdout, nothing else")] = False
