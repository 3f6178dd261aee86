"""`hil schema`: for editors."""

from __future__ import annotations

from typing import Annotated

import typer

from hil.cli._output import print_json
from hil.core.errors import BadInputError
from test_plans import plan_schema


def command(
    kind: Annotated[str, typer.Argument(help="what the schema is for: plan")] = "plan",
) -> int:
    """Print the JSON schema of plan files (yaml-language-server and others complete and check with it)."""
    if kind != "plan":
        raise BadInputError(f"there is no schema for '{kind}'", fix="known: plan")
    print_json(plan_schema())
    return 0
