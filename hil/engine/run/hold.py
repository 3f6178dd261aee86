"""A run that is held: who asked for it, and until when."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from drivers import BusLoop
from hil.core.errors import OrderlyEndError
from hil.core.result import Hold
from hil.engine.bench.ranges import Range
from hil.engine.run.operator import Operator

#: A pause that no one ends within this time ends the run.
LONGEST_PAUSE_S = 600.0
#: What holds a run more often than this would hold it for ever.
MOST_HOLDS = 5
_FIX = "see the recording's events; the bench file has the limits and interlocks"


@dataclass
class _Cause:
    text: str
    needs_operator: bool
    well_for_s: float = 0.0
    timeout_s: float = LONGEST_PAUSE_S
    message: str = ""
    well_since_s: float = math.nan


class Holding:
    """Says to the conductor when the run is to be held, and keeps it so until it may go on.

    Args:
        standing: limits and interlocks that are reached now.
        event: takes an event of the recording.
        recording_time: time in the recording of a bench time, s.
    """

    def __init__(
        self,
        loop: BusLoop,
        operator: Operator,
        standing: Callable[[], Iterable[tuple[Range, str]]],
        event: Callable[[str, str], None],
        recording_time: Callable[[float], float],
    ) -> None:
        self._loop, self._operator, self._standing = loop, operator, standing
        self._event, self._recording_time = event, recording_time
        self._causes: dict[str, _Cause] = {}
        self._asked: Counter[str] = Counter()
        self._end: OrderlyEndError | None = None
        self.active = True  # end steps are not held
        self.causes_shown = ""  # why it is being held now
        self.holds: list[Hold] = []

    def due(self) -> bool:
        """Whether the run is to be held, or ended, at the next safe point."""
        if self._operator.take_pause():
            self._causes.setdefault("operator", _Cause("paused by the operator", needs_operator=True))
        return self.active and bool(self._causes or self._end)

    def ask(self, reached: Range, text: str) -> None:
        """Hold the run because a limit or an interlock was reached."""
        self._asked[reached.name] += 1
        if self._asked[reached.name] > MOST_HOLDS:
            self.end_run(f"{text}; it has already held the run {MOST_HOLDS} times")
            return
        needs_operator = reached.response == "pause"
        self._causes[reached.name] = _Cause(
            text,
            needs_operator,
            reached.well_for_s,
            LONGEST_PAUSE_S if needs_operator else reached.timeout_s,
            reached.message,
        )

    def end_run(self, text: str) -> None:
        """End the run at the next safe point, with its end steps."""
        self._end = self._end or OrderlyEndError(text, where="bench limits", fix=_FIX)

    def refuse_end(self) -> None:
        """Call when nothing is left that could be held.

        Raises:
            OrderlyEndError: the run was to be ended.
        """
        if self._end is not None:
            raise self._end

    def wait(self) -> None:
        """Return when the run may go on.

        Raises:
            OrderlyEndError: it is to be ended, or no one let it go on in time.
            InterruptError: the operator ended it.
            EmergencyStopError: somebody asked for it.
        """
        began_s = self._loop.clock.now_s()
        causes = "; ".join(cause.text for cause in self._causes.values())
        ended_by = "end of the run"
        try:
            self.refuse_end()
            self._begin(causes)
            while self._causes:
                self._operator.pass_time()
                self.refuse_end()
                ended_by = self._look(self._loop.clock.now_s() - began_s) or ended_by
        except BaseException:
            ended_by = "end of the run"
            raise
        finally:
            self.causes_shown = ""
            now_s = self._loop.clock.now_s()
            start_s, end_s = self._recording_time(began_s), self._recording_time(now_s)
            if causes:
                self.holds.append(Hold(start_s=start_s, end_s=end_s, cause=causes, ended_by=ended_by))
        self._event("hold", f"resumes after {now_s - began_s:.3g} s: {ended_by}")

    def _begin(self, causes: str) -> None:
        self._event("hold", f"held, torque off, the dynos hold their speed: {causes}")
        asks = [cause for cause in self._causes.values() if cause.needs_operator]
        if asks and not self._operator.present:
            what = f"{asks[0].text}: held, and there is no terminal to resume from"
            raise OrderlyEndError(what, where="hold", fix=_FIX)
        self._operator.take_resume()
        self.causes_shown = causes
        messages = [cause.message for cause in self._causes.values() if cause.message]
        how = (
            "r and Enter: resume; q and Enter: end the run"
            if asks
            else "resumes by itself when the cause is gone"
        )
        self._operator.tell("\n".join([f"held: {causes}", *messages, how]))

    def _look(self, held_s: float) -> str:
        """Drop causes that are gone; says what has just ended the last of them."""
        standing = {range_.name: text for range_, text in self._standing()}
        resumed = self._operator.take_resume()
        ended_by = ""
        for name, cause in list(self._causes.items()):
            if cause.needs_operator and resumed and name in standing:
                self._operator.tell(f"not yet: {standing[name]}")
            elif cause.needs_operator and resumed:
                del self._causes[name]
                ended_by = "operator"
            elif not cause.needs_operator and self._is_well(cause, name in standing):
                del self._causes[name]
                ended_by = "well again"
            elif held_s > cause.timeout_s:
                what = f"{cause.text}: held for {cause.timeout_s:g} s"
                raise OrderlyEndError(what, where="hold", fix=cause.message or _FIX)
        return ended_by

    def _is_well(self, cause: _Cause, stands: bool) -> bool:
        now_s = self._loop.clock.now_s()
        if stands:
            cause.well_since_s = math.nan
        elif math.isnan(cause.well_since_s):
            cause.well_since_s = now_s
        return now_s - cause.well_since_s >= cause.well_for_s
