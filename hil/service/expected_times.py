"""Which queued run may start when: reservations of others, and what is expected of the queue of a bench."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hil.api_schemas.api import LeaseData, ReservationData, RunData


@dataclass(frozen=True)
class Window:
    """A stretch of time in which a bench is one person's; `reservation` is None where it is a lease."""

    who: str
    begins: datetime.datetime
    ends: datetime.datetime
    admitted: frozenset[int] = frozenset()
    reservation: ReservationData | None = None

    def is_of(self, run: RunData) -> bool:
        """Whether a run may start in it."""
        return run.requested_by == self.who or run.id in self.admitted


@dataclass(frozen=True)
class Expected:
    """When a run is expected to start and to end; None where that is not known."""

    start: datetime.datetime | None = None
    end: datetime.datetime | None = None
    waits_for: ReservationData | None = None


def windows_of(
    reservations: Sequence[ReservationData], lease: LeaseData | None, now: datetime.datetime
) -> list[Window]:
    """All windows of a bench, the earliest first."""
    found = [Window(one.who, one.begins, one.ends, frozenset(one.admitted), one) for one in reservations]
    if lease is not None:
        found.append(Window(lease.holder, now, lease.until))
    return sorted(found, key=lambda one: one.begins)


def blocking(
    run: RunData, windows: Sequence[Window], at: datetime.datetime, duration_s: float | None
) -> Window | None:
    """The window of somebody else that a run would start in, or is expected to reach into.

    A run of unknown duration may start before a window: no one knows that it will not be over by then.
    """
    end = at if duration_s is None else at + datetime.timedelta(seconds=duration_s)
    for window in windows:
        meets = window.begins <= at < window.ends or at < window.begins < end
        if meets and not window.is_of(run):
            return window
    return None


def expected(
    queue: Sequence[RunData],
    windows: Sequence[Window],
    now: datetime.datetime,
    free_at: datetime.datetime | None,
    duration_s: Callable[[int], float | None],
) -> dict[int, Expected]:
    """What is expected of each run of a queue, by its number.

    Args:
        queue: runs that may start, in their order.
        free_at: when the bench can take the next; None: that is not known.
        duration_s: how long a run will take, by its number.
    """
    found = {}
    for run in queue:
        window = blocking(run, windows, now, duration_s(run.id))
        found[run.id] = Expected(waits_for=window.reservation if window else None)
    waiting, at = list(queue), free_at
    while waiting and at is not None:
        moment = at
        may = (one for one in waiting if not blocking(one, windows, moment, duration_s(one.id)))
        first = next(may, None)
        if first is None:  # all wait for the end of a window
            at = min((window.ends for window in windows if window.ends > moment), default=None)
            continue
        waiting.remove(first)
        seconds = duration_s(first.id)
        at = None if seconds is None else moment + datetime.timedelta(seconds=seconds)
        found[first.id] = Expected(moment, at, found[first.id].waits_for)
    return found


def end_of(
    started_at: datetime.datetime | None,
    share: float | None,
    seconds: float | None,
    now: datetime.datetime,
) -> datetime.datetime | None:
    """When a run under way is expected to end, by how long it takes or by the share that is done."""
    if started_at is None:
        return None
    if seconds is not None:
        return max(now, started_at + datetime.timedelta(seconds=seconds))
    if share is None or share < _LEAST_SHARE:
        return None
    return now + (now - started_at) * (1.0 - share) / share


_LEAST_SHARE = 0.05  # before that a share says little about the rest
