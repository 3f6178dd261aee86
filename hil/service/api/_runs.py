"""Runs: wanted, watched, held, ended; and what they leave."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Query
from pydantic import StringConstraints
from starlette.responses import Response

from hil.api_schemas.api import (
    Answer,
    BenchName,
    Me,
    RunChange,
    RunData,
    RunId,
    RunState,
    RunVerdict,
    RunWanted,
)
from hil.execution.run_execution import RunningRun
from hil.service.agents.remote_bench import RemoteBench
from hil.service.api._access import Engineer, Operator, TheService, Viewer
from hil.service.api._benches import known
from hil.service.api._left_files import disposition_of, from_store, headers_of, left_file, media_of
from hil.service.api._problems import RefusedError, missing
from hil.service.service import Service
from hil.service.store import NewRun
from hil.service.worker_pool.plan_reading import hazard_of

router = APIRouter(prefix="/runs", tags=["runs"])
_LAST = 2**31 - 1
#: The key of a step in a plan.
StepKind = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,63}$")]


@router.get("", name="list_runs")
async def list_runs(
    service: TheService,
    me: Viewer,
    bench: Annotated[BenchName | None, Query()] = None,
    state: Annotated[list[RunState] | None, Query(max_length=6)] = None,
    verdict: Annotated[list[RunVerdict] | None, Query(max_length=4)] = None,
    step: Annotated[list[StepKind] | None, Query(max_length=8)] = None,
    before: Annotated[int, Query(ge=1, le=_LAST)] = _LAST,
    most: Annotated[int, Query(ge=1, le=200)] = 50,
) -> list[RunData]:
    """Runs, newest first, of any of the states and verdicts given; `before` is the number of a run.

    With `step`, only runs of plans that have a step of one of these kinds.
    """
    del me
    found = service.runs.all(
        bench=bench, states=state or (), verdicts=verdict or (), before=before, most=most, steps=step or ()
    )
    return [service.with_progress(run) for run in found]


@router.post("", name="queue_run", status_code=201)
async def queue_run(wanted: RunWanted, service: TheService, me: Operator) -> RunData:
    """Queue a run; a run of a hazardous plan waits for the approval of a second person."""
    plan = service.plans.chosen(wanted.plan, wanted.values)
    if plan is None:
        raise missing("plan", wanted.plan)
    hazard = hazard_of(plan)
    if hazard and not me.tokens:
        raise RefusedError(
            403,
            f"the plan is hazardous: {hazard}",
            where=plan.name,
            fix="make tokens (hil serve --add-token), so that a second person can approve it",
        )
    new = NewRun(
        plan=plan.name,
        title=plan.title,
        plan_text=plan.text,
        plan_source=str(plan.source),
        bench=known(service, wanted.bench),
        values=wanted.values,
        requested_by=me.name,
        priority=wanted.priority,
        hazard=hazard,
        confirmed_by=wanted.confirmed_by,
        accept_expired=wanted.accept_expired,
        key=wanted.key,
    )
    run, is_new = service.runs.add(new, approved=not hazard)
    if is_new:
        service.log.add(me.name, me.role, "queue", f"run {run.id}", _asked(run))
        service.wake(run.bench)
        service.changed(run.bench)
    return service.with_progress(run)


@router.get("/{run}", name="get_run")
async def get_run(run: RunId, service: TheService, me: Viewer) -> RunData:
    """A run."""
    del me
    return service.queue_forecast.of_run(service.with_progress(there(service, run)))


@router.patch("/{run}", name="change_run")
async def change_run(run: RunId, change: RunChange, service: TheService, me: Engineer) -> RunData:
    """Change the place of a run in its queue."""
    found = there(service, run)
    if not service.runs.set_priority(run, change.priority):
        raise RefusedError(409, f"run {run} is no longer queued")
    return _done(service, me, found, "priority", str(change.priority))


@router.post("/{run}/approve", name="approve_run")
async def approve_run(run: RunId, service: TheService, me: Engineer) -> RunData:
    """Approve a run of a hazardous plan; not possible for the person who queued it."""
    found = there(service, run)
    if found.requested_by == me.name:
        raise RefusedError(403, "a second person approves it", where=f"run {run}")
    if not service.runs.approve(run, me.name):
        raise RefusedError(409, f"run {run} does not wait for approval")
    return _done(service, me, found, "approve")


@router.post("/{run}/pause", name="pause_run")
async def pause_run(run: RunId, service: TheService, me: Operator) -> RunData:
    """Hold a run at its next safe point; without an answer it ends after ten minutes."""
    _running(service, run).process.pause()
    return _done(service, me, there(service, run), "pause")


@router.post("/{run}/resume", name="resume_run")
async def resume_run(run: RunId, service: TheService, me: Operator) -> RunData:
    """Resume a held run."""
    _running(service, run).process.resume()
    return _done(service, me, there(service, run), "resume")


@router.post("/{run}/answer", name="answer_run")
async def answer_run(run: RunId, answer: Answer, service: TheService, me: Operator) -> RunData:
    """Answer the operator's prompt of a run."""
    _running(service, run).process.answer(answer.text)
    return _done(service, me, there(service, run), "answer", answer.text)


@router.post("/{run}/abort", name="abort_run")
async def abort_run(run: RunId, service: TheService, me: Operator) -> RunData:
    """End a run: a queued run is cancelled; an active run does its end steps and keeps its data."""
    found = there(service, run)
    running = service.running_run(run)
    if running is not None:
        running.process.end()
        running.ending = True
    elif not service.runs.cancel(run, f"cancelled by {me.name}"):
        raise RefusedError(409, f"run {run} is finished")
    return _done(service, me, found, "abort")


@router.get("/{run}/files/{name}", name="get_run_file", response_class=Response)
async def get_run_file(
    run: RunId,
    name: str,
    service: TheService,
    me: Viewer,
    wanted: Annotated[str | None, Header(alias="range")] = None,
) -> Response:
    """A file of a finished run, or the `range` of it; from the store if the service no longer has it."""
    del me
    if name not in service.with_progress(there(service, run)).files:
        raise missing("file", name)
    path = service.queue.folder_of(run) / name
    other, shown = "application/octet-stream" if path.suffix == ".mcap" else "text/plain", f"{run}-{name}"
    kept = None if path.is_file() or service.keeper is None else service.keeper.kept(run, name)
    if kept is not None and service.keeper is not None:
        headers = headers_of(path) | {"content-disposition": f'{disposition_of(path)}; filename="{shown}"'}
        return await from_store(service.keeper, run, kept, media_of(path, other), headers, wanted)
    return left_file(path, shown, other)


def there(service: Service, run: int) -> RunData:
    """A run that there is.

    Raises:
        RefusedError: there is none.
    """
    found = service.runs.get(run)
    if found is None:
        raise missing("run", run)
    return found


def _asked(run: RunData) -> str:
    """What was asked for, for the audit log: two runs of a plan with other values are not told alike."""
    return ", ".join(
        [f"{run.plan} on {run.bench}", *(f"{name} = {one:.12g}" for name, one in run.values.items())]
    )


def _running(service: Service, run: int) -> RunningRun:
    wanted, found = there(service, run), service.running_run(run)
    if found is None and wanted.bench not in service.benches:
        raise RefusedError(
            409, f"run {run} belongs to another service", fix=f"use the service of {wanted.bench}"
        )
    if found is None:
        raise RefusedError(409, f"run {run} is not active")
    bench = service.benches[wanted.bench]
    if isinstance(bench, RemoteBench) and bench.agent.away:
        raise RefusedError(
            409, bench.state()[1], fix="it can be ended; its agent gets the order when it reconnects"
        )
    return found


def _done(service: Service, me: Me, run: RunData, action: str, detail: str = "") -> RunData:
    """Write it down, have it looked at, and show the run as it is now."""
    service.log.add(me.name, me.role, action, f"run {run.id}", detail)
    service.wake(run.bench)
    service.changed(run.bench)
    return service.with_progress(there(service, run.id))
