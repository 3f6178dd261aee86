"""`hil schema`: for editors."""

from __future__ import annotations

from hil.app.schemas import SCHEMAS
from hil.cli.options.files import Schema
from hil.cli.output import print_json
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable


def execute(options: Schema) -> int:
    """Execute the command; its exit code."""
    kind = options.kind
    if kind not in SCHEMAS:
        raise BadInputError(
            f"there is no schema for '{printable(kind, 60)}'", fix=did_you_mean(kind, SCHEMAS)
        )
    print_json(SCHEMAS[kind]())
    return 0
