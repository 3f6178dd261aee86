"""The list of all runs, filtered, sorted and paged where they are kept."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from hil.api_schemas.api import OVER, PlanName
from hil.api_schemas.run_list import FoundRuns, RunChoices, RunsWanted
from hil.service.api._access import TheService, Viewer

router = APIRouter(prefix="/run-list", tags=["runs"])


@router.get("", name="find_runs")
async def find_runs(wanted: Annotated[RunsWanted, Query()], service: TheService, me: Viewer) -> FoundRuns:
    """A page of all runs that pass every filter, and how many do; files of runs are not named here."""
    del me
    found = service.run_list.find(wanted)
    for one in found.runs:
        if one.run.state not in OVER:
            one.run = service.with_progress(one.run)
    return found


@router.get("/choices", name="list_run_choices")
async def list_run_choices(
    service: TheService, me: Viewer, plan: Annotated[list[PlanName] | None, Query(max_length=50)] = None
) -> RunChoices:
    """What runs can be filtered by."""
    del me
    return service.run_list.choices(plan or [])
