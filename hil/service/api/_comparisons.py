"""Two runs side by side."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query

from hil.api_schemas.api import OVER, RunData, RunId
from hil.api_schemas.comparison import BestRunData, ChannelName, ComparisonData, SegmentName, TracesData
from hil.engine import RECORDING
from hil.service.api._access import TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.service import Service

router = APIRouter(prefix="/comparisons", tags=["runs"])
_Seconds = Annotated[float | None, Query(ge=-1e6, le=1e6, allow_inf_nan=False)]


@router.get("", name="compare_runs")
async def compare_runs(
    service: TheService, me: Viewer, first: Annotated[RunId, Query()], other: Annotated[RunId, Query()]
) -> ComparisonData:
    """Criteria of two runs with their differences, and the inputs that differ; they may be of two plans."""
    del me
    one, two = _over(service, first), _over(service, other)
    found = await service.worker_pool.ask(
        "comparison", first=await _named(service, one), other=await _named(service, two)
    )
    return ComparisonData(first=one, other=two, **found)


@router.get("/best", name="find_best_run")
async def find_best_run(service: TheService, me: Viewer, run: Annotated[RunId, Query()]) -> BestRunData:
    """Of the runs that passed the same criteria with the same limits, the one farthest from its limits.

    Those of its own plan with its own values come first.
    """
    del me
    of = _over(service, run)
    criteria = service.run_list.criteria_beside(of.id)
    usual = {
        plan.name: {name: one.default for name, one in plan.variables.items()} for plan in service.plans.all()
    }
    found = await service.worker_pool.ask(
        "best_run", run=of.id, passed=of.verdict == "pass", criteria=criteria, usual=usual
    )
    best = found["run"]
    return BestRunData(**{**found, "run": None if best is None else service.runs.get(best)})


@router.get("/traces", name="compare_traces")
async def compare_traces(
    service: TheService,
    me: Viewer,
    first: Annotated[RunId, Query()],
    other: Annotated[RunId, Query()],
    segment: Annotated[SegmentName, Query()],
    channel: Annotated[ChannelName, Query()],
    start_s: _Seconds = None,
    end_s: _Seconds = None,
    most: Annotated[int, Query(ge=10, le=4000)] = 600,
) -> TracesData:
    """A channel of a segment of both runs, as lowest and highest value in each of `most` buckets."""
    del me
    runs: dict[str, Any] = {
        name: await _named(service, _over(service, run)) for name, run in (("first", first), ("other", other))
    }
    found = await service.worker_pool.ask(
        "traces", **runs, segment=segment, channel=channel, start_s=start_s, end_s=end_s, most=most
    )
    return TracesData(**found)


def _over(service: Service, run: int) -> RunData:
    found = service.runs.get(run)
    if found is None:
        raise missing("run", run)
    if found.state not in OVER:
        raise RefusedError(409, f"run {run} is not finished", fix="wait for its end")
    return service.with_progress(found)


async def _named(service: Service, run: RunData) -> tuple[str, str]:
    """The run's name in a comparison, and its recording."""
    if RECORDING not in run.files:
        raise RefusedError(409, f"run {run.id} has no recording", fix="compare runs that have a recording")
    return f"run {run.id}", str((await service.file_of(run.id, RECORDING)).resolve())
