"""Emergency stops as the service has them: from its API, and from its stop post.

A stop on a bench that is stopped already changes nothing: it goes again to whatever may move, and leaves
a row in the audit log only if somebody else asks than before. So however often it is repeated, rows are few.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections import defaultdict
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.execution.background import apart
from hil.execution.benches import Bench
from hil.service.stop_post import Stopped, StopPost
from hil.service.store import DatabaseAwayError, in_turns

if TYPE_CHECKING:
    from hil.service.service import Service

_MOST_ROWS = 16  # of one stop, until it is reset
_LATCHED_WITHIN_S = 5.0
_LATE_S = 1.0

logger = logging.getLogger(__name__)


class Stops:
    """Tells runs and agents, latches benches, and writes down who asked."""

    def __init__(self, service: Service, stop_post: StopPost | None) -> None:
        self._service, self.post = service, stop_post
        self._rows: dict[str, tuple[str, set[tuple[str, str]]]] = {}  # of the latch that there is now
        self._tasks: set[asyncio.Task[None]] = set()
        self._repeated: defaultdict[str, int] = defaultdict(int)
        if stop_post is not None:
            stop_post.stopped = self._of_post

    def tell_run(self, bench: str, asked: EmergencyAsked) -> None:
        """Tell the run under way or just being started, if there is one; asks no one anything before."""
        running = self._service.running(bench)
        if running is not None:
            running.process.stop_in_emergency(asked)
        elif self._service.own(bench) is not None:
            self._service.queue.stop_next(bench, asked)

    async def stop(self, bench: str, asked: EmergencyAsked, role: str) -> None:
        """Have a bench safe at once and keep it so, whatever its run is doing and whether there is one.

        Raises:
            HilError: the stop cannot be latched; a run has been stopped all the same.
        """
        self.tell_run(bench, asked)
        service = self._service
        own, running = service.own(bench), service.running(bench)
        folder = running.folder if running is not None else Path()
        try:
            if own is None:
                service.agents.stop_in_emergency(bench, asked)
                self._remember(bench, asked)
            else:
                await asyncio.wait_for(apart(partial(_latch, own, asked, folder)), _LATCHED_WITHIN_S)
        except TimeoutError:  # a disk that hangs; it goes on
            logger.error("%s: its emergency stop is not on the disk yet", bench)
        finally:
            self._write_down(bench, asked, role)
            service.changed(bench)

    def reset(self, bench: str) -> None:
        """Somebody lets a bench be armed again: the next stop is a new one."""
        self._rows.pop(bench, None)
        repeated = self._repeated.pop(bench, 0)
        if repeated:
            logger.info("%s: its emergency stop was asked for %d times more", bench, repeated)
        if self.post is not None:
            self.post.reset(bench)

    def _of_post(self, stopped: Stopped) -> None:
        """The stop post has stopped the run and latched the bench; agents hear of it from here."""
        service = self._service
        if stopped.problem:
            logger.error("%s: its emergency stop is NOT latched: %s", stopped.bench, stopped.problem)
        if stopped.bench not in service.benches:
            return
        asked = EmergencyAsked(by=stopped.by, origin=stopped.origin, way=stopped.way)
        if service.own(stopped.bench) is None:
            service.agents.stop_in_emergency(stopped.bench, asked)
            self._remember(stopped.bench, asked)
        self._write_down(stopped.bench, asked, stopped.role, stopped.at_s)
        service.changed(stopped.bench)

    def _remember(self, bench: str, asked: EmergencyAsked) -> None:
        """Have the next service tell the agent too, if this one ends before; no one waits for it."""

        async def remembered() -> None:
            with contextlib.suppress(DatabaseAwayError):  # the agent hears of it all the same
                self._service.agents.remember_stop(bench, asked)

        task = asyncio.create_task(in_turns(remembered()))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _write_down(self, bench: str, asked: EmergencyAsked, role: str, at_s: float | None = None) -> None:
        """A row in the log; a service that stood still writes late, and says when it was asked for."""
        own, one = self._service.own(bench), (asked.by, asked.origin)
        latch = own.stopped() if own is not None else ""
        if self._rows.get(bench, (None,))[0] != latch:
            self._rows[bench] = latch, set()
        rows = self._rows[bench][1]
        if one in rows or len(rows) >= _MOST_ROWS:
            self._repeated[bench] += 1
            return
        rows.add(one)
        detail = f"from {asked.origin}, {asked.way}"
        if at_s is not None and time.time() - at_s > _LATE_S:
            detail += f", asked for at {datetime.fromtimestamp(at_s, UTC).isoformat(timespec='milliseconds')}"
        self._service.deferred_audit.add(asked.by, role, "emergency stop", bench, detail)


def _latch(bench: Bench, asked: EmergencyAsked, folder: Path) -> None:
    """One latch says it; more would only fill the disk.

    Raises:
        HilError: it cannot be written.
    """
    if not bench.stopped():
        bench.stop(asked.by, folder, origin=asked.origin, way=asked.way)
