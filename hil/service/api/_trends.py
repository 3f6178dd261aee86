"""Criteria from run to run."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from hil.api_schemas.api import BenchName, PlanName, RunId, TrendData
from hil.service.api._access import TheService, Viewer
from hil.service.api._benches import known
from hil.service.trends import trends

router = APIRouter(tags=["runs"])


@router.get("/trends", name="trends")
async def get_trends(
    service: TheService,
    me: Viewer,
    bench: Annotated[BenchName, Query()],
    plan: Annotated[PlanName, Query()],
    dut: Annotated[str | None, Query(max_length=200)] = None,
    most: Annotated[int, Query(ge=1, le=500)] = 100,
    like: Annotated[
        RunId | None, Query(description="the run of whose values they are; null: the newest")
    ] = None,
) -> list[TrendData]:
    """Each criterion of a plan over its newest runs with the same values, with limits, scatter and Cpk."""
    del me
    return trends(service.runs.criteria(known(service, bench), plan, dut, most, like))
