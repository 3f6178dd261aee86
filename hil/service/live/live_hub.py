"""Live data for the viewers of each bench: the run under way or the last one, and its judgement.

What many viewers get is encoded once.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import time
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from hil.api_schemas.api import LastSpeed
from hil.core.errors import HilError
from hil.core.recording import write_overview
from hil.core.result import CriterionResult
from hil.engine import RECORDING
from hil.engine.run.zero import STANDSTILL_RAD_S
from hil.execution.data_folder import folder_of
from hil.execution.run_execution import PLAN, RunningRun
from hil.service.live.bucket_texts import BucketTexts
from hil.service.live.live import LiveRun
from test_plans import plan_from_text


class BroadcastCache:
    """The newest text of each kind that viewers were sent."""

    def __init__(self) -> None:
        self._newest: dict[str, tuple[object, str]] = {}
        self._state: tuple[int, str] = (-1, "")
        self._making = asyncio.Lock()

    def text(self, kind: str, of: Hashable, make: Callable[[], str]) -> str:
        """What was stated of it, or what `make` says."""
        known, text = self._newest.get(kind, (None, ""))
        if known != of:
            text = make()
            self._newest[kind] = of, text
        return text

    async def state(self, version: Callable[[], int], make: Callable[[], str]) -> tuple[int, str]:
        """The newest state and its version; it reads the store, so whoever comes meanwhile waits for it."""
        async with self._making:
            if (now := version()) != self._state[0]:
                self._state = now, make()
            return self._state


_SEEN_S = 10.0  # while an axle turns it is looked at every five or six seconds
_LOOK_S = 0.05  # a viewer is sent as many updates
_JUDGE_S = 1.0


@dataclass
class LiveView:
    """The newest run of a bench, under way or over, as it is shown."""

    run: int
    live: LiveRun
    criteria: tuple[CriterionResult, ...] = ()
    judged_s: float = 0.0
    kept: bool = False  # its overview, for when it is over
    texts: BucketTexts = field(init=False)

    def __post_init__(self) -> None:
        self.texts = BucketTexts(self.live.buckets)

    looked_s: float = field(default_factory=time.monotonic)


def last_speed(speed_rad_s: float, at: datetime.datetime) -> LastSpeed:
    """A motor's speed, and whether that is more than standstill."""
    return LastSpeed(speed_rad_s=speed_rad_s, at=at, turns=abs(speed_rad_s) > STANDSTILL_RAD_S)


class LiveHub:
    """Viewers of benches, what they are shown, and when there is something new.

    Args:
        benches: names of all benches.
        running: the run under way on a bench.
        overviews: where what is read of a run is kept for those who look at it afterwards.
    """

    def __init__(
        self,
        benches: Callable[[], Iterable[str]],
        running: Callable[[str], RunningRun | None],
        overviews: Path,
    ) -> None:
        self._benches, self._running, self._overviews = benches, running, overviews
        self.viewers: defaultdict[str, dict[asyncio.Event, str]] = defaultdict(dict)  # each with a name
        self.caches: defaultdict[str, BroadcastCache] = defaultdict(BroadcastCache)  # of each bench
        self._runs: dict[str, LiveView] = {}
        self._version: defaultdict[str, int] = defaultdict(int)
        self._heard: dict[str, LastSpeed] = {}  # of stopped benches that no run has seen to stand
        self._unheard: dict[str, str] = {}  # why not, by bench

    def run_of(self, bench: str) -> LiveView | None:
        """The run that is shown of a bench."""
        return self._runs.get(bench)

    def last_speed(self, bench: str) -> LastSpeed | None:
        """The motor's speed as it was heard or in the last sample of the newest run and its run-down.

        The newer of the two.
        None if neither is known.
        """
        known = filter(None, (self._heard.get(bench), self.measured_speed(bench)))
        return max(known, key=lambda one: one.at, default=None)

    def seen_turning(self, bench: str) -> LastSpeed | None:
        """The motor's speed where it was just seen to turn; None if it stands, or nothing says so of now."""
        last, moment = self.last_speed(bench), datetime.datetime.now(datetime.UTC)
        return last if last and last.turns and (moment - last.at).total_seconds() <= _SEEN_S else None

    def why_no_speed(self, bench: str) -> str:
        """Why the speed of a bench could not be heard; '' if it was, or if no one has listened."""
        return self._unheard.get(bench, "")

    def measured_speed(self, bench: str) -> LastSpeed | None:
        """The motor's speed in the last sample of the newest run of this service; None if there is none."""
        shown = self._runs.get(bench)
        measured = shown.live.last_speed if shown else None
        return None if measured is None else last_speed(*measured)

    def take_heard(self, bench: str, speed: LastSpeed) -> None:
        """Show a speed that was heard after the newest run."""
        self._heard[bench] = speed
        self._unheard.pop(bench, None)
        self.changed(bench)

    def take_unheard(self, bench: str, why: str) -> None:
        """Show why a speed could not be heard."""
        if why != self._unheard.get(bench):
            self._unheard[bench] = why
            self.changed(bench)

    def forget_heard(self, bench: str) -> None:
        """A bench is driven again: what was heard before says nothing any more."""
        self._heard.pop(bench, None)
        self._unheard.pop(bench, None)

    def runs(self) -> set[int]:
        """Numbers of all runs that are shown."""
        return {shown.run for shown in self._runs.values()}

    def names_of_viewers(self, bench: str) -> list[str]:
        """Who watches a bench, each once, in order of their names."""
        return sorted(set(self.viewers[bench].values()))

    def changed(self, bench: str) -> None:
        """Something of a bench is to be shown anew."""
        self._version[bench] += 1
        self._tell(bench)

    def version(self, bench: str) -> int:
        """Counts what `changed` was called for."""
        return self._version[bench]

    def overview_folder(self, run: int) -> Path:
        """Where the overview of a run is kept."""
        return folder_of(self._overviews, run)

    async def follow(self, closing: Callable[[], bool]) -> None:
        """Read what runs measure, until the service is closed."""
        next_s = time.monotonic()
        while not closing():
            for name in list(self._benches()):
                self._follow(name)
                await self._judge(name)
                await self._keep(name)
            next_s = max(next_s + _LOOK_S, time.monotonic())
            await asyncio.sleep(next_s - time.monotonic())

    def _follow(self, bench: str) -> None:
        running, shown = self._running(bench), self._runs.get(bench)
        if running is not None and (shown is None or shown.run != running.data.id):
            if shown is not None:
                shown.live.close()
            try:
                plan_file = running.folder / PLAN
                plan = plan_from_text(
                    plan_file.read_text("utf-8"), str(plan_file), running.folder, files_required=False
                )
            except (HilError, OSError):
                return
            shown = LiveView(running.data.id, LiveRun(running.folder / RECORDING, plan))
            self._runs[bench] = shown
        if shown is None:
            return
        passed_s, shown.looked_s = time.monotonic() - shown.looked_s, time.monotonic()
        if shown.live.look(passed_s):
            self._tell(bench)

    async def _judge(self, bench: str) -> None:
        shown = self._runs.get(bench)
        if shown is None or time.monotonic() - shown.judged_s < _JUDGE_S:
            return
        shown.judged_s = time.monotonic()
        found = await asyncio.to_thread(shown.live.decided)
        if found is not None:
            shown.criteria = found
            self.changed(bench)

    async def _keep(self, bench: str) -> None:
        """Write down what was read of a run that is over; where that fails, it is read again when needed."""
        shown = self._runs.get(bench)
        if shown is None or shown.kept or not shown.live.over:
            return
        shown.kept, overview = True, shown.live.overview()
        self.changed(bench)  # its last speed is known now
        if overview is not None:
            with contextlib.suppress(OSError, HilError):
                await asyncio.to_thread(write_overview, overview, self.overview_folder(shown.run))

    def _tell(self, bench: str) -> None:
        for event in self.viewers[bench]:
            event.set()
