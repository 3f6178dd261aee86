"""Reservations of benches, and their queues with expected times."""

from __future__ import annotations

from fastapi import APIRouter

from hil.api_schemas.api import BenchName, Me, ReservationData, RunData, RunId
from hil.api_schemas.team import ReservationWanted
from hil.service.api._access import Operator, TheService, Viewer
from hil.service.api._benches import known
from hil.service.api._problems import RefusedError, missing
from hil.service.api._reserved import refuse_leased, span, taken
from hil.service.api._runs import there
from hil.service.service import Service

router = APIRouter(prefix="/benches/{bench}", tags=["benches"])


@router.get("/queue", name="get_queue")
async def get_queue(bench: BenchName, service: TheService, me: Viewer) -> list[RunData]:
    """Runs that wait for a bench in their order, with expected times and the reservations they wait for."""
    del me
    return service.waiting(known(service, bench)).runs


@router.get("/reservations", name="list_reservations")
async def list_reservations(bench: BenchName, service: TheService, me: Viewer) -> list[ReservationData]:
    """Present and future reservations of a bench, the next first."""
    del me
    return service.reservations.of(known(service, bench))


@router.post("/reservations", name="reserve_bench", status_code=201)
async def reserve_bench(
    bench: BenchName, wanted: ReservationWanted, service: TheService, me: Operator
) -> ReservationData:
    """Reserve a bench: queued runs of others do not start meanwhile."""
    refuse_leased(service, known(service, bench), me, wanted.begins)
    found, is_new = service.reservations.add(bench, me.name, wanted)
    if not is_new:
        raise taken(found)
    _changed(service, bench, me, "reserve", f"{span(found)}: {found.reason}")
    return found


@router.delete("/reservations/{reservation}", name="remove_reservation", status_code=204)
async def remove_reservation(bench: BenchName, reservation: RunId, service: TheService, me: Operator) -> None:
    """Remove a reservation of one's own; administrators remove those of others."""
    found = _mine(service, bench, reservation, me)
    service.reservations.remove(reservation)
    _changed(service, bench, me, "reservation removed", f"{found.who}, {span(found)}")


@router.put("/reservations/{reservation}/runs/{run}", name="admit_run", status_code=204)
async def admit_run(
    bench: BenchName, reservation: RunId, run: RunId, service: TheService, me: Operator
) -> None:
    """Let a queued run of another person start within one's own reservation."""
    found = _mine(service, bench, reservation, me)
    if there(service, run).bench != bench:
        raise RefusedError(409, f"run {run} is for another bench", where=bench)
    service.reservations.admit(reservation, run)
    _changed(service, bench, me, "run admitted", f"run {run} in {span(found)}")


def _mine(service: Service, bench: str, reservation: int, me: Me) -> ReservationData:
    found = service.reservations.get(known(service, bench), reservation)
    if found is None:
        raise missing("reservation", reservation)
    if found.who != me.name and me.role != "admin":
        raise RefusedError(
            403, f"the reservation is {found.who}'s", where=bench, fix="ask them or an administrator"
        )
    return found


def _changed(service: Service, bench: str, me: Me, action: str, detail: str) -> None:
    service.log.add(me.name, me.role, action, bench, detail)
    service.wake(bench)
    service.changed(bench)
