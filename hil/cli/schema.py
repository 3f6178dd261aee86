"""`hil schema`: for editors."""

from __future__ import annotations

from hil.cli._output import print_json
from hil.core.errors import BadInputError
from test_plans import plan_schema


def carry_out(
    *,
    kind: str,
) -> int:
    """Carry the command out; its exit code."""
    if kind != "plan":
        raise BadInputError(f"there is no schema for '{kind}'", fix="known: plan")
    print_json(plan_schema())
    return 0
