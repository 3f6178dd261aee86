"""`hil init`: a folder of one's own, ready to run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._lean_imports import import_python_can


def command(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="a new folder, or an empty one")],
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Make a folder with a plan, a simulated bench, its model, a controller and a test for pytest.

    `hil check`, `hil run` and `pytest` work there as it stands; README.md in it says how.
    """
    import_python_can()
    from hil.cli.init import carry_out

    return carry_out(folder=folder, as_json=as_json)
