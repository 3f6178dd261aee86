"""Whose turn it is on a bench: priority and order, within what people have reserved."""

from __future__ import annotations

import datetime

from hil.api_schemas.api import RunData
from hil.service.durations import Durations
from hil.service.expected_times import Expected, Window, blocking, expected, windows_of
from hil.service.store import LeaseStore, ReservationStore, RunStore

_MOST_LOOKED_AT = 500


class Turns:
    """The queue of each bench as people may use it now."""

    def __init__(
        self, runs: RunStore, leases: LeaseStore, reservations: ReservationStore, durations: Durations
    ) -> None:
        self._runs, self._leases, self._reservations = runs, leases, reservations
        self._durations = durations

    def next_of(self, bench: str) -> RunData | None:
        """The run whose turn it is, if any may start now."""
        now = _now()
        windows = self.windows(bench, now)
        queue = self._runs.queued(bench, _MOST_LOOKED_AT if windows else 1)
        if not windows:
            return queue[0] if queue else None
        may = (run for run in queue if not blocking(run, windows, now, self._durations.at_once(run.id)))
        return next(may, None)

    def windows(self, bench: str, now: datetime.datetime) -> list[Window]:
        """Whose the bench is, and from when to when."""
        return windows_of(self._reservations.of(bench), self._leases.of(bench), now)

    def expected(self, bench: str, free_at: datetime.datetime | None, most: int) -> dict[int, Expected]:
        """When the first runs of a bench's queue are expected to start and to end, by their numbers."""
        queue = self._runs.queued(bench, most)
        if not queue:
            return {}
        now = _now()
        return expected(queue, self.windows(bench, now), now, free_at, self._durations.of)


def _now() -> datetime.datetime:
    return datetime.datetime.now(datetime.UTC)
