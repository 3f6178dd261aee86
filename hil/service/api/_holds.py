"""What holds a bench in service: runs, people who have it for themselves, studies that drive it."""

from __future__ import annotations

from hil.api_schemas.api import RunData, RunState
from hil.api_schemas.study import STUDY_OVER
from hil.service.api._problems import RefusedError
from hil.service.api._reserved import moment, span
from hil.service.service import Service

_OPEN: tuple[RunState, ...] = ("queued", "waiting_approval", "running")
_LAST = 2**31 - 1
_MOST_NAMED = 5
_DOES = {
    "queued": "waits in its queue",
    "waiting_approval": "waits for approval",
    "running": "is under way",
}


def refuse_held(service: Service, bench: str) -> None:
    """Refuse to take a bench out of service that somebody counts on.

    Raises:
        RefusedError: names what holds it, the first of each kind first.
    """
    found = _holding(service, bench)
    if not found:
        return
    named = "; ".join(found[:_MOST_NAMED])
    more = f"; and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
    raise RefusedError(
        409,
        f"stays in service: {named}{more}",
        where=bench,
        fix="await or cancel runs and studies, have reservations and leases given back, then try again",
    )


def _holding(service: Service, bench: str) -> list[str]:
    runs = service.runs.all(bench=bench, states=_OPEN, before=_LAST, most=2 * _MOST_NAMED)
    found = [_run_in_words(run) for run in reversed(runs)]
    lease = service.leases.of(bench)
    if lease is not None:
        found.append(f"{lease.holder} has it until {moment(lease.until)}")
    found += [
        f"{one.who} has reserved it {span(one)}: {one.reason}" for one in service.reservations.of(bench)
    ]
    found += [
        f"the {one.kind} {one.id} of {one.requested_by} uses it"
        for one in service.studies.own()
        if one.bench == bench and one.state not in STUDY_OVER
    ]
    return found


def _run_in_words(run: RunData) -> str:
    return f"run {run.id} ({run.plan}, of {run.requested_by}) {_DOES[run.state]}"
