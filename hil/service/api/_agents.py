"""What agents ask: what there is to do for their benches, and that files of runs are taken."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Path, Query, Request

from hil.api_schemas.agent import (
    MOST_FILE_BYTES,
    AgentData,
    AgentId,
    AgentOrders,
    AgentReport,
    AgentsForecast,
    Delivered,
    FileThere,
    RunEnding,
    RunFileName,
    Taken,
)
from hil.api_schemas.api import BenchName, RunData, RunId
from hil.core.errors import HilError
from hil.execution.data_folder import LOCK
from hil.service.agents.remote_bench import RemoteBench
from hil.service.api._access import AgentItself, Engineer, TheService, Viewer
from hil.service.api._given_files import PIECE
from hil.service.api._problems import RefusedError, missing
from hil.service.service import Service

router = APIRouter(tags=["agents"])
_WAITS_S = 0.5  # for something to do, so that an agent hears it at once


@router.get("/agents", name="list_agents")
async def list_agents(service: TheService, me: Viewer) -> list[AgentData]:
    """Agents with benches at this service, and the times of their last reports."""
    del me
    return service.agents.all()


@router.put("/agents/{agent}", name="report_of_agent")
async def report_of_agent(
    agent: AgentId, report: Annotated[AgentReport, Body()], service: TheService, me: AgentItself
) -> AgentOrders:
    """Register an agent's benches and report their state; the answer, within 0.5 s, has its tasks."""
    new, refused = service.agents.heard(agent, report)
    for bench in new:
        service.log.add(
            me.name, me.role, "bench registered", bench, f"agent {report.name} on {report.machine}"
        )
    orders = service.agents.orders(agent, refused)
    if not (orders.orders or orders.waiting or refused or report.leaving or service.closing):
        await service.agents.wait_for_orders(agent, _WAITS_S)
        orders = service.agents.orders(agent, refused)
    return orders


@router.post("/agents/{agent}/benches/{bench}/take", name="take_run")
async def take_run(agent: AgentId, bench: BenchName, service: TheService, me: AgentItself) -> Taken:
    """Take the next run of a bench; the agent owns it from then on."""
    place = service.agents.benches.get(bench)
    if place is None or place.agent.id != agent:
        raise RefusedError(409, f"'{bench}' does not belong to this agent")
    try:
        taken = service.agents.take(agent, bench)
    except HilError as error:
        service.deferred_audit.add(me.name, me.role, "run not taken", f"{bench}: {error}")
        raise
    if taken is not None:
        service.log.add(
            me.name, me.role, "take", f"run {taken.data.id}", f"{bench}, agent {place.agent.name}"
        )
    return Taken(run=taken)


@router.put("/agents/{agent}/runs/{run}/files/{name}", name="send_run_file", openapi_extra=PIECE)
async def send_run_file(
    agent: AgentId,
    run: RunId,
    name: RunFileName,
    request: Request,
    service: TheService,
    me: AgentItself,
    at: Annotated[int, Query(ge=0, le=MOST_FILE_BYTES)] = 0,
) -> FileThere:
    """Append a piece to a run's file, if it starts at the file's present end; returns the size."""
    del me
    _of_agent(service, run, agent)
    if name == LOCK:
        raise RefusedError(422, "is not a file of a run", where=name)
    return FileThere(size=service.run_uploads.add(run, name, at, await request.body()))


@router.post("/agents/{agent}/runs/{run}/ending", name="deliver_run")
async def deliver_run(
    agent: AgentId, run: RunId, ending: Annotated[RunEnding, Body()], service: TheService, me: AgentItself
) -> Delivered:
    """Report the end of a run; the run is finished when all of its files are uploaded."""
    if service.run_uploads.run_of(run, agent) is None and service.run_uploads.are_those(run, ending.files):
        return Delivered(missing=[])  # the answer to the first time went astray
    found = _of_agent(service, run, agent)
    wanting = await service.run_uploads.missing(run, ending.files)
    if not wanting and service.run_uploads.finish(found, agent, ending):
        service.log.add(me.name, me.role, "run delivered", f"run {run}", ending.state)
        service.agents.over(run, found.bench)
        service.wake(found.bench)
    return Delivered(missing=wanting)


@router.put("/agents/{agent}/forecasts/{order}", name="answer_forecast", status_code=204)
async def answer_forecast(
    agent: AgentId,
    order: Annotated[str, Path(pattern=r"^[0-9a-f]{16}$")],
    answer: Annotated[AgentsForecast, Body()],
    service: TheService,
    me: AgentItself,
) -> None:
    """Report an agent's forecast of a plan."""
    del agent, me
    if not service.agents_forecasts.answer(order, answer):
        raise missing("forecast that is waited for", order)


@router.delete("/benches/{bench}/agent", name="let_agent_go", status_code=204)
async def let_agent_go(bench: BenchName, service: TheService, me: Engineer) -> None:
    """Release the bench of an agent that is not connected; its run is interrupted, its data are kept."""
    place = service.benches.get(bench)
    if not isinstance(place, RemoteBench):
        raise missing("bench of an agent", bench)
    if not place.agent.away:
        raise RefusedError(409, "its agent is connected", where=bench, fix="end that one (Ctrl-C) first")
    service.agents.let_go(bench, me.name)
    service.log.add(me.name, me.role, "agent let go", bench, place.agent.name)


def _of_agent(service: Service, run: int, agent: str) -> RunData:
    found = service.run_uploads.run_of(run, agent)
    if found is None:
        raise RefusedError(409, f"run {run} does not belong to this agent, or is finished")
    return found
