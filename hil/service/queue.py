"""The queue: begins the runs of each bench one after the other, each in a process of its own.

A run is written down as running before its process is started, and as over when that has ended. Whatever
the moment at which the service is killed: what was running is found again, and is never started twice.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from hil.api_schemas.agent import TakenRun
from hil.api_schemas.api import BenchState, RunData
from hil.core.errors import BenchError, HilError
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.execution.benches import Bench
from hil.execution.data_folder import folder_of
from hil.execution.motor_speed import only_listens
from hil.execution.run_execution import RunEnd, RunExecution, RunningRun, end_of_left
from hil.execution.run_process import alive_in
from hil.service.stop_post import StopPost
from hil.service.store import BenchStore, DatabaseAwayError, RunStore, in_turns
from hil.service.turns import Turns

_LOOK_S = 0.5  # how often a bench is looked at that cannot be driven now
_USED_S = 1.0  # how old that look may be for those who ask over the API
_HELD_AGAIN_S = 20.0  # a third of how long a bench is held
_LAST_WRITE_S = 5.0  # how long the end of a run waits for a database that is away when the service ends

logger = logging.getLogger(__name__)


@dataclass
class _Place:
    """A bench and what goes on on it."""

    bench: Bench
    running: RunExecution | None = None
    left: list[RunData] = field(default_factory=list)  # of an earlier service, perhaps still ending
    used_by: str = ""
    looked_s: float = -1e9
    held_by: str = ""  # another service of the same database
    held_s: float = -1e9
    dropped: bool = False  # taken out of service
    stopped_by: EmergencyAsked | None = None  # while the run's process was being started
    unsure: int | None = None  # taken while the database went away: perhaps so, and certainly not started


class Queue:
    """Runs the runs.

    Args:
        turns: whose turn it is on a bench.
        folder: where each run has a folder of its own, by its number.
        source: where a plan lies here by its name, with what it loads beside it.
        changed: called whenever something is to be shown anew, with the bench's name.
        stop_post: has a stop line of each run from before its process begins until it has ended.
    """

    def __init__(
        self,
        benches: dict[str, Bench],
        runs: RunStore,
        turns: Turns,
        held: BenchStore,
        folder: Path,
        source: Callable[[str], Path],
        changed: Callable[[str], None],
        stop_post: StopPost | None = None,
    ) -> None:
        self._stop_post = stop_post
        self._places = {name: _Place(bench) for name, bench in benches.items()}
        self._runs, self._turns, self._held = runs, turns, held
        self._folder = folder
        self._source, self._changed = source, changed
        self._wake = asyncio.Event()
        self._tasks: set[asyncio.Task[None]] = set()
        self._closing = False
        self._closing_s = 0.0
        for place in self._places.values():
            self._refuse_held(place)
        for run in runs.running(held.service):
            if run.bench in self._places:
                self._places[run.bench].left.append(run)
            elif not alive_in(self.folder_of(run.id)):
                self._conclude_left(run)

    def folder_of(self, run: int) -> Path:
        """Where the files of a run are."""
        return folder_of(self._folder, run)

    def add(self, bench: Bench) -> None:
        """Drive one more bench.

        Raises:
            BenchError: another service drives it.
        """
        place = _Place(bench)
        self._refuse_held(place)
        self._places[bench.name] = place

    def drop(self, bench: str) -> bool:
        """Begin nothing more on a bench; false while a run is under way there.

        It is still known: who looks at all benches may just be looking at it.
        """
        place = self._places[bench]
        if place.running is not None or place.left or place.unsure is not None:
            return False
        place.dropped = True
        return True

    def wake(self) -> None:
        """Look at all benches now."""
        self._wake.set()

    def running(self, bench: str) -> RunningRun | None:
        """The run under way on a bench."""
        return self._places[bench].running

    def running_run(self, run: int) -> RunningRun | None:
        """A run by its number, if it is under way."""
        found = (place.running for place in self._places.values())
        return next((one for one in found if one is not None and one.data.id == run), None)

    def stop_next(self, bench: str, asked: EmergencyAsked) -> None:
        """Stop the run of which the process is just being started, if there is one."""
        self._places[bench].stopped_by = asked

    def state(self, bench: str) -> tuple[BenchState, str]:
        """What a bench does, and why it may not be driven."""
        place = self._places[bench]
        stopped = place.bench.stopped()
        if stopped:
            return "emergency_stop", stopped
        if place.running is not None:
            return "running", place.running.shown
        if place.left:
            return "ending", f"run {place.left[0].id} of an earlier service process is being ended"
        if place.held_by:
            return "in_use", place.held_by
        used = self._used_by(place)
        return ("in_use", used) if used and not only_listens(used) else ("free", "")

    async def work(self) -> None:
        """Begin runs as benches become free, until `close`."""
        while not self._closing:
            with contextlib.suppress(DatabaseAwayError):  # nothing is started until it answers
                for place in [one for one in self._places.values() if not one.dropped]:
                    await self._look(place)
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._wake.wait(), _LOOK_S)
            self._wake.clear()

    async def close(self, hurry: Callable[[], bool]) -> None:
        """Begin nothing more and end what is under way; wait for its end unless somebody is in a hurry."""
        self._closing, self._closing_s = True, time.monotonic()
        self._wake.set()
        for place in self._places.values():
            if place.running is not None:
                place.running.process.leave()
        while self._tasks and not hurry():
            await asyncio.wait(self._tasks, timeout=0.1)

    def _refuse_held(self, place: _Place) -> None:
        place.held_by, place.held_s = self._held.hold(place.bench.name), time.monotonic()
        if place.held_by:
            raise BenchError(
                f"another service of the same database drives the bench: {place.held_by}",
                where=place.bench.name,
                fix="end that service, or remove this bench here",
            )

    def _hold(self, place: _Place) -> None:
        """Go on driving a bench, or hear who does."""
        if time.monotonic() - place.held_s > _HELD_AGAIN_S:
            there = self._held.hold(place.bench.name)
            place.held_s = time.monotonic()
            if there != place.held_by:
                place.held_by = there
                self._changed(place.bench.name)

    async def _look(self, place: _Place) -> None:
        self._hold(place)
        if place.unsure is not None:
            self._runs.put_back(place.unsure)
            place.unsure = None
        for left in list(place.left):
            if not alive_in(self.folder_of(left.id)):
                self._conclude_left(left)
                place.left.remove(left)
                self._changed(left.bench)
        if place.running is not None or place.left or place.held_by or place.bench.stopped():
            return
        run = self._turns.next_of(place.bench.name)
        if run is None or self._used_by(place, fresh=True):
            return
        place.unsure = run.id
        taken = self._runs.take(run.id, self._held.service)
        place.unsure = None
        if taken is not None:
            await self._begin(place, taken)
        else:
            place.held_s = -1e9  # it is looked at once more whose the bench is

    def _used_by(self, place: _Place, *, fresh: bool = False) -> str:
        if fresh or time.monotonic() - place.looked_s > _USED_S:
            place.used_by, place.looked_s = place.bench.used_by(), time.monotonic()
        return place.used_by

    async def _begin(self, place: _Place, taken: TakenRun) -> None:
        run, place.stopped_by = taken.data, None
        try:
            taken = taken.model_copy(update={"plan_source": str(self._source(run.plan))})
            place.running = await self._begin_run(place.bench, taken)
        except DatabaseAwayError:
            place.unsure = run.id
            return
        except OSError as error:  # no descriptor, no memory for a process: it is tried again
            logger.error("run %d cannot be started now: %s", run.id, error)
            place.unsure = run.id
            return
        except HilError as error:
            code, why = error.exit_code, str(error)
            await self._written(lambda: self._runs.end(run.id, "ended", exit_code=code, reason=why))
            self._changed(run.bench)
            return
        if place.stopped_by is not None:
            place.running.process.stop_in_emergency(place.stopped_by)
        logger.info("run %d begins on %s", run.id, run.bench)
        self._changed(run.bench)
        task = asyncio.create_task(in_turns(self._watch(place, place.running)))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _begin_run(self, bench: Bench, taken: TakenRun) -> RunExecution:
        """Begin a run with its stop line."""
        run, folder, post = taken.data.id, self.folder_of(taken.data.id), self._stop_post
        if post is None:
            return await RunExecution.begin(taken, bench, folder)
        line = post.add_line(bench.name, run, folder)
        try:
            return await RunExecution.begin(taken, bench, folder, line.reading)
        except BaseException:
            post.drop_line(run)
            raise
        finally:
            os.close(line.reading)

    async def _watch(self, place: _Place, running: RunExecution) -> None:
        """Listen to a run until it has ended, and write down how."""
        bench = running.data.bench
        end = await running.ended(place.bench, lambda: self._changed(bench), lambda: self._closing)
        running.doing = "its result is being stored"
        try:
            await self._written(lambda: self._write(running.data, end))
        finally:
            place.running = None
            if self._stop_post is not None:
                self._stop_post.drop_line(running.data.id)
            self.wake()
            self._changed(bench)

    async def _written(self, write: Callable[[], object]) -> None:
        """Write to the store as soon as it answers; what a service could not write the next one does."""
        while True:
            try:
                write()
            except DatabaseAwayError:
                if self._closing and time.monotonic() > self._closing_s + _LAST_WRITE_S:
                    return
                await asyncio.sleep(_LOOK_S)
            else:
                return

    def _conclude_left(self, run: RunData) -> None:
        """Mark a run whose service was killed; its process has ended."""
        place = self._places.get(run.bench)
        end = end_of_left(self.folder_of(run.id), "service", place.bench if place is not None else None)
        logger.warning("run %d: %s", run.id, end.reason)
        self._write(run, end)

    def _write(self, run: RunData, end: RunEnd) -> None:
        if end.state == "queued":
            logger.info("run %d waits again: somebody was quicker on %s", run.id, run.bench)
            self._runs.put_back(run.id)
            return
        self._runs.end(
            run.id,
            end.state,
            exit_code=end.exit_code,
            result=end.result,
            reason=end.reason,
            dut=end.dut,
            at=end.at,
        )
        logger.info("run %d ended on %s with code %s", run.id, run.bench, end.exit_code)
