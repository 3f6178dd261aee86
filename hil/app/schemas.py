"""JSON schemas of the files that people write, by kind."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hil.core.controller import controller_schema
from hil.core.model.schema import model_schema
from hil.engine.bench.bench_file import bench_schema
from test_plans import plan_schema


def _campaign_schema() -> dict[str, Any]:
    from hil.analysis.campaigns import campaign_schema  # with statistics: a second that others do not need

    return campaign_schema()


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "plan": plan_schema,
    "bench": bench_schema,
    "model": model_schema,
    "controller": controller_schema,
    "campaign": _campaign_schema,
}
