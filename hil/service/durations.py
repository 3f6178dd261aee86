"""How long queued runs will take: as the newest of the same plan did, else as is predicted."""

from __future__ import annotations

import asyncio
import contextlib
import datetime
from collections.abc import Awaitable, Callable, Sequence

from hil.api_schemas.api import RunData
from hil.core.errors import HilError
from hil.service.store import DatabaseAwayError, DurationStore

_LOOK_S = 2.0
#: A run whose turn comes sooner needs no forecast, which takes a processor for seconds.
_PREDICTED_AFTER_S = 10.0


class Durations:
    """Seconds by run, of runs that wait or are under way; looked up beside the queue."""

    def __init__(self, store: DurationStore) -> None:
        self._store = store
        self._known: dict[int, float | None] = {}
        self._predicted: set[int] = set()

    def of(self, run: int) -> float | None:
        """How long a run will take, s; None if that is not known."""
        return self._known.get(run)

    def at_once(self, run: int) -> float | None:
        """As `of`, but what was measured is looked up now if it was not yet: a run may start at once."""
        if run not in self._known:
            self._known[run] = self._store.measured_s(run)
        return self._known[run]

    async def work(
        self,
        present: Callable[[], Sequence[RunData]],
        predict: Callable[[RunData], Awaitable[float | None]],
        changed: Callable[[str], None],
        closing: Callable[[], bool],
    ) -> None:
        """Look up runs that are present, until the service is closed; expected times are shown anew.

        Args:
            predict: seconds that a run will take by the clock on the wall; None if no one can say.
        """
        while not closing():
            with contextlib.suppress(DatabaseAwayError):
                runs = present()
                await self._look(runs, predict)
                for bench in {run.bench for run in runs if run.state == "queued"}:
                    changed(bench)
            await asyncio.sleep(_LOOK_S)

    async def _look(
        self, runs: Sequence[RunData], predict: Callable[[RunData], Awaitable[float | None]]
    ) -> None:
        present = {run.id for run in runs}
        self._known = {run: seconds for run, seconds in self._known.items() if run in present}
        self._predicted &= present
        for run in runs:
            if run.id not in self._known:
                self._known[run.id] = self._store.measured_s(run.id)
        late = [run for run in runs if self._known[run.id] is None and self._is_late(run)]
        for run in late[:1]:  # one after the other: meanwhile others may have started
            self._predicted.add(run.id)
            with contextlib.suppress(HilError, OSError):
                self._known[run.id] = await predict(run)

    def _is_late(self, run: RunData) -> bool:
        waited = datetime.datetime.now(datetime.UTC) - run.queued_at
        return (
            run.state == "queued"
            and run.id not in self._predicted
            and waited.total_seconds() > _PREDICTED_AFTER_S
        )
