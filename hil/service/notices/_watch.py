"""What happened, by looking: runs that have ended or wait for approval, benches that were stopped."""

from __future__ import annotations

import asyncio
import contextlib
from typing import TYPE_CHECKING

from hil.api_schemas.api import OVER, RunData
from hil.core.errors import HilError
from hil.execution.background import apart
from hil.service.notices._notice import of_drifts, of_run, of_stop, of_test
from hil.service.notices._post import Post, Seen
from hil.service.notices._senders import send
from hil.service.store import DatabaseAwayError
from hil.service.trends import trends

if TYPE_CHECKING:
    from hil.service.service import Service

_LOOK_S = 1.0
_MOST = 1000
_NEWEST = 100  # runs of a trend, as the page shows it
_LAST = 2**31 - 1


class NoticeWatch:
    """Sees what is worth a notice on the benches of a service, also what happened while it was down."""

    def __init__(self, service: Service, post: Post) -> None:
        self._service, self._post = service, post
        self._stopped: set[str] | None = None

    async def work(self) -> None:
        """Look and send until the service closes."""
        while not self._service.closing:
            with contextlib.suppress(DatabaseAwayError):
                if self._look():
                    await apart(self._post.keep)
                if await apart(self._post.send_due):
                    await apart(self._post.keep)
                for name, why in self._post.given_up:
                    self._service.deferred_audit.add("service", "", "notice given up", name, why)
                self._post.given_up.clear()
            await asyncio.sleep(_LOOK_S)

    def _look(self) -> bool:
        """Whether there was anything new."""
        before = self._post.seen
        runs = self._runs(before)
        asked = {run.id for run in runs if run.state == "waiting_approval"}
        if before is not None:  # what was over before anybody wanted notices is no news
            new = (run for run in runs if run.id in before.open_runs or run.id > before.last_run)
            for run in new:
                notice = of_run(run, self._post.settings.address)
                if notice is not None and not (run.id in asked and run.id in before.asked):
                    self._post.add(notice)
                if run.state == "ended":
                    self._look_for_drifts(run)
        last = max((run.id for run in runs), default=0)
        last = max(last, before.last_run if before is not None else 0)
        still = frozenset(run.id for run in runs if run.state not in OVER)
        self._post.seen = Seen(last, still, frozenset(asked))
        return self._look_at_stops() or self._post.seen != before

    def _runs(self, before: Seen | None) -> list[RunData]:
        """The newest runs of the service's benches, and those that were open, in their order."""
        runs, benches = self._service.runs, self._service.benches
        newest = runs.all(bench=None, states=(), before=_LAST, most=_MOST)
        found = {run.id: run for run in newest if run.bench in benches}
        for number in before.open_runs - found.keys() if before is not None else ():
            run = runs.get(number)
            if run is not None:
                found[number] = run
        return [found[number] for number in sorted(found)]

    def _look_for_drifts(self, run: RunData) -> None:
        points = self._service.runs.criteria(run.bench, run.plan, run.dut or None, _NEWEST)
        for notice in of_drifts(run, trends(points), self._post.settings.address):
            self._post.add(notice)

    def _look_at_stops(self) -> bool:
        """Benches that were stopped since the last look; a stop before the first look is no news."""
        states = {name: self._service.state(name) for name in self._service.benches}
        stopped = {name for name, (state, _) in states.items() if state == "emergency_stop"}
        new = stopped - self._stopped if self._stopped is not None else set()
        self._stopped = stopped
        for name in sorted(new):
            self._post.add(of_stop(name, states[name][1], self._post.settings.address))
        return bool(new)


def send_test(post: Post) -> list[tuple[str, str]]:
    """Send a test to each recipient now: its name, and what went wrong ('' if nothing did)."""
    outcomes = []
    for one in post.settings.recipients:
        problem = ""
        try:
            send(of_test(post.settings.address), one)
        except HilError as error:
            problem = str(error)
        outcomes.append((one.name, problem))
    return outcomes
