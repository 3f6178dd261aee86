"""`hil schema`: for editors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hil.cli.options.files import Schema
from hil.cli.output import print_json
from hil.core.controller import controller_schema
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable
from hil.core.model.schema import model_schema
from hil.engine.bench.bench_file import bench_schema
from test_plans import plan_schema


def _campaign_schema() -> dict[str, Any]:
    from hil.analysis.campaigns import (
        campaign_schema,
    )  # with statistics: a second that the others do not need

    return campaign_schema()


_SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "plan": plan_schema,
    "bench": bench_schema,
    "model": model_schema,
    "controller": controller_schema,
    "campaign": _campaign_schema,
}


def execute(options: Schema) -> int:
    """Execute the command; its exit code."""
    kind = options.kind
    if kind not in _SCHEMAS:
        raise BadInputError(
            f"there is no schema for '{printable(kind, 60)}'", fix=did_you_mean(kind, _SCHEMAS)
        )
    print_json(_SCHEMAS[kind]())
    return 0
