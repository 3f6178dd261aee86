"""The bench's limits, watched on every sample of every source, below any plan."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from drivers import Samples, Stream
from hil.core.channels import unit_of
from hil.core.errors import BenchError, LimitTripError
from hil.core.result import LimitResult
from hil.engine.bench.range_scan import StreamRanges
from hil.engine.bench.ranges import Interlock, Limits, Range, ranges_of

_PAUSE_S = 0.03  # wires are looked at every 10 ms
#: Longer than this no one watches the bench: RMCU and dynos have long gone to safety by themselves.
LONGEST_PAUSE_S = 0.5
_TEMPERATURES = ("K", "degC", "°C")
_OF_MOTION = ("N m", "rad/s", "rad", "km/h", "m/s", "m/s²", "1/min", "rpm")
_MATTERS_S = 0.045  # an RMCU takes a host that is silent for 50 ms for gone
_MAY_BE_BLAMED_S = 0.5  # devices tell within this time what they made of a host that was silent


@dataclass
class OwnPauses:
    """How often and for how long (s) the loop that watches stood still itself, and when that last ended."""

    count: int = 0
    longest_s: float = 0.0
    last_s: float = 0.0
    ended_s: float = -np.inf

    def blamed_at(self, now_s: float) -> str:
        """What to say of a failure that comes so soon after a pause that the pause may be its cause."""
        if now_s - self.ended_s > _MAY_BE_BLAMED_S or self.last_s < _MATTERS_S:
            return ""
        return f"the bench loop was delayed by {self.last_s:.2g} s just before"


class LimitWatch:
    """Trips when a channel stays out of its range for longer than the persistence, or a stream falls silent.

    Ranges with another response than a trip go to `answer`, with words for what was reached, once each
    time that they are reached.

    The persistence counts in samples of the channel's own stream, at least one: a single odd sample never
    trips. A value that the device does not know (NaN) is not known to be within the range.

    Silence counts only while somebody listened: a time in which this loop itself stood still is no silence
    of a device. It is kept in `pauses`, and is a fault of the bench only beyond `LONGEST_PAUSE_S`. What
    devices have to say of a silence, `why_silent` gives in words.
    """

    def __init__(
        self,
        streams: Sequence[Stream],
        limits: Limits,
        interlocks: Mapping[str, Interlock] | None = None,
        answer: Callable[[Range, str], None] = lambda reached, text: None,
        why_silent: Callable[[], str] = lambda: "",
    ) -> None:
        ranges = ranges_of(limits, interlocks)
        self._watched = {stream: StreamRanges(stream, ranges) for stream in streams}
        self._answer, self._why_silent = answer, why_silent
        self._seen_s = dict.fromkeys(streams, -np.inf)
        self._looked_s = np.inf
        self.pauses = OwnPauses()
        self.active = False

    @property
    def largest(self) -> dict[str, float]:
        """Largest magnitude of each limited channel so far."""
        found: dict[str, float] = {}
        for watched in self._watched.values():
            found |= watched.largest()
        return found

    @property
    def results(self) -> tuple[LimitResult, ...]:
        """Each limit and interlock with what was reached so far."""
        return tuple(result for watched in self._watched.values() for result in watched.results())

    def standing(self) -> Iterator[tuple[Range, str]]:
        """Ranges that are reached now, with words for each."""
        for watched in self._watched.values():
            yield from watched.stands()

    def take(self, samples: Samples, now_s: float) -> None:
        """Look at samples that were handed out at `now_s` of the bench clock.

        Raises:
            LimitTripError: a limit tripped.
            BenchError: what `answer` raises.
        """
        self._seen_s[samples.stream] = now_s
        watched = self._watched[samples.stream]
        if watched.look(samples) and self.active:
            for reached, text in watched.reached():
                if reached.response == "trip":
                    raise LimitTripError(
                        f"limit tripped: {text}",
                        where="bench limits",
                        fix=f"{_advice(samples.stream, reached.channel)}; the limit is in the bench file",
                    )
                self._answer(reached, text)

    def look_for_silence(self, now_s: float) -> None:
        """Call when every source has been asked.

        Raises:
            BenchError: samples stopped coming, or this loop stood still for too long.
        """
        pause_s, self._looked_s = now_s - self._looked_s, now_s
        if not self.active:
            return
        if pause_s > _PAUSE_S:
            self._stood_still(pause_s, now_s)
        self.refuse_silence(now_s)

    def refuse_silence(self, now_s: float) -> None:
        """Raises:
        BenchError: samples of a stream have stopped coming, or never came.
        """
        for stream, seen_s in self._seen_s.items():
            if now_s - seen_s > stream.silence_s:
                why = self._why_silent()
                raise BenchError(
                    f"{stream.label} has stopped coming{f' ({why})' if why else ''}",
                    where=stream.where,
                    fix="check its wiring and its sender" if why else "is the device powered?",
                )

    def standing_still(self, now_s: float) -> bool:
        """Whether this loop has just stood still, and has not looked at what came meanwhile."""
        return now_s - self._looked_s > _PAUSE_S

    def _stood_still(self, pause_s: float, now_s: float) -> None:
        pauses = self.pauses
        pauses.count += 1
        pauses.longest_s = max(pauses.longest_s, pause_s)
        pauses.last_s, pauses.ended_s = pause_s, now_s
        self._seen_s = {stream: min(seen_s + pause_s, now_s) for stream, seen_s in self._seen_s.items()}
        if pause_s > LONGEST_PAUSE_S:
            raise BenchError(
                f"the bench loop was delayed by {pause_s:.2g} s, more than {LONGEST_PAUSE_S:g} s",
                where="this computer",
                fix="close other programs, and record to a faster disk",
            )


def _advice(stream: Stream, channel: str) -> str:
    """What brings a channel back within its limit, as far as its unit says."""
    unit = dict(zip(stream.channels, stream.units, strict=True)).get(channel) or unit_of(channel)
    if unit in _TEMPERATURES:
        return "let it cool down and look at its cooling, or have the plan ask for less, or for less long"
    if unit in _OF_MOTION:
        return "lower the plan's torque or speed"
    return "look at what this channel measures, and at the plan's steps before it"
