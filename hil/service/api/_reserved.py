"""Who has a bench for themselves at a time, and refusals that say so."""

from __future__ import annotations

import datetime

from hil.api_schemas.api import Me, ReservationData
from hil.service.api._problems import RefusedError
from hil.service.service import Service


def refuse_reserved(service: Service, bench: str, me: Me, for_s: float) -> None:
    """Refuse a lease that would meet a reservation of somebody else.

    Raises:
        RefusedError: says whose, and until when.
    """
    until = datetime.datetime.now(datetime.UTC) + datetime.timedelta(seconds=for_s)
    for one in service.reservations.of(bench):
        if one.who != me.name and one.begins < until:
            raise taken(one)


def refuse_leased(service: Service, bench: str, me: Me, begins: datetime.datetime) -> None:
    """Refuse a reservation that would meet a lease of somebody else.

    Raises:
        RefusedError: says whose, and until when.
    """
    lease = service.leases.of(bench)
    if lease is not None and lease.holder != me.name and begins < lease.until:
        what = f"{lease.holder} holds the bench until {moment(lease.until)}"
        raise RefusedError(409, what, where=bench, fix="choose another time")


def taken(found: ReservationData) -> RefusedError:
    """Somebody has the bench then."""
    return RefusedError(
        409,
        f"{found.who} has reserved the bench {span(found)}: {found.reason}",
        where=found.bench,
        fix="choose another time",
    )


def span(found: ReservationData) -> str:
    """From when to when, in words."""
    return f"from {moment(found.begins)} to {moment(found.ends)}"


def moment(at: datetime.datetime) -> str:
    """A moment in words."""
    return f"{at.astimezone(datetime.UTC):%Y-%m-%d %H:%M} UTC"
