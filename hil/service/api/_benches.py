"""Benches: what they do, stopping them, letting them move again, having one for oneself."""

from __future__ import annotations

from fastapi import APIRouter, Request

from hil.api_schemas.api import BenchData, BenchName, LeaseData, LeaseWanted
from hil.core.errors import StopWay
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.service.api._access import Engineer, Operator, TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.api._reserved import refuse_reserved
from hil.service.service import Service
from hil.service.stop_post import COOKIE

router = APIRouter(tags=["benches"])


def known(service: Service, bench: str) -> str:
    """The name of a bench that there is.

    Raises:
        RefusedError: there is none.
    """
    if bench not in service.benches:
        raise missing("bench", bench)
    return bench


@router.get("/benches", name="list_benches")
async def list_benches(service: TheService, me: Viewer) -> list[BenchData]:
    """All benches and their states."""
    del me
    return [service.bench_data(name) for name in service.benches]


@router.get("/benches/{bench}", name="get_bench")
async def get_bench(bench: BenchName, service: TheService, me: Viewer) -> BenchData:
    """A bench and its state."""
    del me
    return service.bench_data(known(service, bench))


@router.post("/benches/{bench}/emergency-stop", name="stop_in_emergency")
async def stop_in_emergency(bench: BenchName, service: TheService, request: Request) -> BenchData:
    """Make a bench safe at once, until it is reset. Allowed for everyone, without a token."""
    asked, role = _asked(service, request)
    await service.stops.stop(known(service, bench), asked, role)
    return service.bench_data(bench, ask=False)


@router.post("/emergency-stop", name="stop_all_in_emergency")
async def stop_all_in_emergency(service: TheService, request: Request) -> list[BenchData]:
    """Make all benches safe at once, until they are reset. Allowed for everyone, without a token."""
    asked, role = _asked(service, request)
    for bench in list(service.benches):
        service.stops.tell_run(bench, asked)
    for bench in list(service.benches):
        await service.stops.stop(bench, asked, role)
    return [service.bench_data(name, ask=False) for name in service.benches]


def _asked(service: Service, request: Request) -> tuple[EmergencyAsked, str]:
    """Who asks, if they say so and are known, with their role: no one is refused here, no database asked."""
    header = request.headers.get("authorization", "")
    secret = header[7:] if header.lower().startswith("bearer ") else request.cookies.get(COOKIE, "")
    address = request.client.host if request.client else "unknown"
    owner = service.owners.of(secret)
    by, role = (owner.name, owner.role) if owner is not None else (f"somebody at {address}", "")
    way: StopWay = "page" if "origin" in request.headers else "api"
    return EmergencyAsked(by=by, origin=address, way=way), role


@router.post("/benches/{bench}/reset", name="reset_bench")
async def reset_bench(bench: BenchName, service: TheService, me: Engineer) -> BenchData:
    """Reset an emergency stop, so that the bench can be armed again."""
    known(service, bench)
    if service.running(bench) is not None:
        raise RefusedError(409, "a run is still being ended", where=bench, fix="wait for its end")
    _refuse_turning(service, bench)
    count = await service.reset(bench, me.name)
    if count is None:
        raise RefusedError(
            409, "its agent does not answer", where=bench, fix="check that the agent is running"
        )
    service.log.add(me.name, me.role, "reset", bench, f"{count} {'stop' if count == 1 else 'stops'}")
    service.wake(bench)
    service.changed(bench)
    return service.bench_data(bench)


def _refuse_turning(service: Service, bench: str) -> None:
    """Nobody confirms that an axle stands which was just seen to turn.

    Raises:
        RefusedError: it was.
    """
    seen = service.live_hub.seen_turning(bench)
    if seen is not None:
        speed = f"{abs(seen.speed_rad_s):.1f} rad/s"
        raise RefusedError(
            409,
            f"the axle turns: at the last look the motor had {speed}",
            where=bench,
            fix="wait until it stands, or brake it; then reset",
        )


@router.put("/benches/{bench}/lease", name="take_lease")
async def take_lease(bench: BenchName, wanted: LeaseWanted, service: TheService, me: Operator) -> LeaseData:
    """Reserve a bench for a time: runs of others wait. Repeat the request to extend it."""
    refuse_reserved(service, known(service, bench), me, wanted.for_s)
    lease = service.leases.take(known(service, bench), me.name, wanted.for_s)
    if lease is None:
        raise RefusedError(409, "another user holds the bench", where=bench, fix="wait until it is released")
    service.log.add(me.name, me.role, "lease", bench, f"{wanted.for_s:g} s")
    service.changed(bench)
    return lease


@router.delete("/benches/{bench}/lease", name="give_lease_back")
async def give_lease_back(bench: BenchName, service: TheService, me: Operator) -> BenchData:
    """Release a reserved bench; an engineer can release it for another user."""
    lease = service.leases.of(known(service, bench))
    if lease is not None and lease.holder != me.name and me.role not in ("engineer", "admin"):
        raise RefusedError(403, f"{lease.holder} holds the bench", where=bench)
    service.leases.give_back(bench)
    service.log.add(me.name, me.role, "lease given back", bench)
    service.wake(bench)
    service.changed(bench)
    return service.bench_data(bench)
