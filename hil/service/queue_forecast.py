"""When runs of a service's queues are expected to start and to end."""

from __future__ import annotations

import datetime
from typing import TYPE_CHECKING

from hil.api_schemas.api import ReservationData, RunData
from hil.service.expected_times import Expected, end_of

if TYPE_CHECKING:
    from hil.service.service import Service

_MOST_SHOWN = 100


class QueueForecast:
    """Expected times, by what benches do now, durations of runs and reservations of people."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._shown: dict[str, str] = {}  # whose reservation of a bench is under way, as it was last

    def of_run(self, run: RunData) -> RunData:
        """A run with when it is expected to start and to end, where this service knows its bench."""
        service = self._service
        if run.state == "queued" and run.bench in service.benches:
            return self.of_queue(run.bench, [run])[0]
        if run.state == "running" and service.running_run(run.id) is not None:
            return run.model_copy(update={"expected_end": self._end_on(run.bench)})
        return run

    def of_queue(self, bench: str, runs: list[RunData]) -> list[RunData]:
        """Runs that wait for a bench, with when they are expected to start and to end."""
        if not runs:
            return runs
        free = self._service.state(bench)[0] == "free"
        free_at = datetime.datetime.now(datetime.UTC) if free else self._end_on(bench)
        found = self._service.turns.expected(bench, free_at, _MOST_SHOWN)
        return [_with(run, found.get(run.id, Expected())) for run in runs]

    def reservation(self, bench: str) -> ReservationData | None:
        """The reservation of a bench that is under way."""
        now = datetime.datetime.now(datetime.UTC)
        return next((one for one in self._service.reservations.of(bench) if one.begins <= now), None)

    def show_reservations(self) -> None:
        """Have benches shown anew of which a reservation begins or is over."""
        for bench in list(self._service.benches):
            found = self.reservation(bench)
            present = found.who if found is not None else ""
            if self._shown.get(bench, "") != present:
                self._shown[bench] = present
                self._service.changed(bench)

    def present_runs(self) -> list[RunData]:
        """Runs that are under way here, and the first that wait for each bench."""
        service = self._service
        running = [service.running(name) for name in service.benches]
        queued = [service.runs.queued(name, _MOST_SHOWN) for name in service.benches]
        return [one.data for one in running if one is not None] + [run for runs in queued for run in runs]

    async def predicted_s(self, run: RunData) -> float | None:
        """Seconds by a forecast; None of a simulated bench, whose clock is not that on the wall.

        Raises:
            HilError: it cannot be predicted.
        """
        service = self._service
        bench, plan = service.benches.get(run.bench), service.plans.chosen(run.plan, run.values)
        if bench is None or plan is None or bench.simulated:
            return None
        own = service.own(run.bench)
        return (await service.forecast(plan, run.bench)).duration_s / (own.file.time_scale if own else 1.0)

    def _end_on(self, bench: str) -> datetime.datetime | None:
        """When the run under way on a bench is expected to end; None if there is none, or no one knows."""
        running, now = self._service.running(bench), datetime.datetime.now(datetime.UTC)
        if running is None:
            return None
        run = running.data
        return end_of(run.started_at, running.share, self._service.durations.of(run.id), now)


def _with(run: RunData, one: Expected) -> RunData:
    found = {"expected_start": one.start, "expected_end": one.end, "waits_for": one.waits_for}
    return run.model_copy(update=found)
