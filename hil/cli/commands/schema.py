"""`hil schema`: for editors."""

from __future__ import annotations

from typing import Annotated

import typer


def command(
    kind: Annotated[str, typer.Argument(help="what the schema is for: plan")] = "plan",
) -> int:
    """Print the JSON schema of plan files (yaml-language-server and others complete and check with it)."""
    from hil.cli.schema import carry_out

    return carry_out(kind=kind)
