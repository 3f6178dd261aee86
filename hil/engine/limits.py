"""The bench's limits, watched on every sample of every source, below any plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivers import Samples, Stream
from hil.core.compiled import compiled
from hil.core.errors import BenchError
from hil.engine.bench_tables import Limits

_PAUSE_S = 0.03  # wires are looked at every 10 ms
#: Longer than this nobody watches the bench: RMCU and dynos have long gone to safety by themselves.
LONGEST_PAUSE_S = 0.5
_MATTERS_S = 0.045  # an RMCU takes a host that is silent for 50 ms for gone
_MAY_BE_BLAMED_S = 0.5  # devices tell within this time what they made of a host that was silent


def limits_of_channels(limits: Limits) -> dict[str, float]:
    """Largest magnitude of each watched channel; a side's share of the shaft torque is half."""
    return {
        "motor_torque_ref_nm": limits.motor_torque_nm,
        "motor_torque_nm": limits.motor_torque_nm,
        "motor_speed_rad_s": limits.motor_speed_rad_s,
        "wheel_speed_left_rad_s": limits.wheel_speed_rad_s,
        "wheel_speed_right_rad_s": limits.wheel_speed_rad_s,
        "shaft_torque_left_nm": 0.5 * limits.shaft_torque_nm,
        "shaft_torque_right_nm": 0.5 * limits.shaft_torque_nm,
        "vehicle_speed_m_s": limits.vehicle_speed_m_s,
    }


@dataclass(frozen=True)
class Range:
    """Where a channel may be, in its unit, and for how long (s) it may be elsewhere."""

    channel: str
    below: float
    above: float
    persistence_s: float


def ranges_of(limits: Limits) -> list[Range]:
    """Every limit of a bench file: magnitudes of the axle's channels, and those given by channel."""
    found = [
        Range(channel, -largest, largest, limits.persistence_s)
        for channel, largest in limits_of_channels(limits).items()
    ]
    for channel, given in limits.channels.items():
        below = -np.inf if given.below is None else given.below
        above = np.inf if given.above is None else given.above
        persistence_s = limits.persistence_s if given.persistence_s is None else given.persistence_s
        found.append(Range(channel, below, above, persistence_s))
    return found


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
        return f"own loop stood still for {self.last_s:.2g} s just before"


class LimitWatch:
    """Trips when a channel stays out of its range for longer than the persistence, or a stream falls silent.

    The persistence counts in samples of the channel's own stream, at least one: a single odd sample never
    trips. A value that the device does not know (NaN) is not known to be within the range.

    Silence counts only while somebody listened: a time in which this loop itself stood still is no silence
    of a device. It is kept in `pauses`, and is a fault of the bench only beyond `LONGEST_PAUSE_S`.
    """

    def __init__(self, streams: Sequence[Stream], limits: Limits) -> None:
        ranges = ranges_of(limits)
        self._watched = {stream: _Watched(stream, ranges) for stream in streams}
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

    def take(self, samples: Samples, now_s: float) -> None:
        """Look at samples that were handed out at `now_s` of the bench clock.

        Raises:
            BenchError: a limit tripped.
        """
        self._seen_s[samples.stream] = now_s
        tripped = self._watched[samples.stream].look(samples)
        if self.active and tripped:
            raise BenchError(
                tripped,
                where="bench limits",
                fix="lower the plan's torque or speed; the limit is in the bench file",
            )

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
        for stream, seen_s in self._seen_s.items():
            if now_s - seen_s > stream.silence_s:
                raise BenchError(
                    f"{stream.label} has stopped coming", where=stream.where, fix="is the device powered?"
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
                f"own loop stood still for {pause_s:.2g} s, more than {LONGEST_PAUSE_S:g} s",
                where="this computer",
                fix="let no other program keep it busy, and record to a disk that keeps up",
            )


class _Watched:
    """The ranges of one stream's channels."""

    def __init__(self, stream: Stream, ranges: list[Range]) -> None:
        self._ranges = [r for r in ranges if r.channel in stream.channels]
        self._units = [stream.units[stream.channels.index(r.channel)] for r in self._ranges]
        self._columns = np.array([stream.channels.index(r.channel) for r in self._ranges], np.int64)
        self._ends = np.array([(r.below, r.above) for r in self._ranges]).reshape(-1, 2)
        allowed = [max(1, round(r.persistence_s / stream.period_s)) for r in self._ranges]
        self._allowed = np.array(allowed, np.int64)
        self._extremes = np.zeros((len(self._ranges), 2))
        self._beyond = np.zeros(len(self._ranges), np.int64)
        self._any = False

    def look(self, samples: Samples) -> str:
        """What to say of a limit that tripped; empty if none did."""
        if not self._ranges:
            return ""
        if not self._any:
            self._any = True
            self._extremes[:] = np.nan_to_num(samples.values[:1, self._columns].T, nan=np.inf)
        index = _scan(samples.values, self._columns, self._ends, self._allowed, self._extremes, self._beyond)
        return self._told(index) if index >= 0 else ""

    def largest(self) -> dict[str, float]:
        magnitudes = np.max(np.abs(self._extremes), axis=1)
        return {r.channel: float(v) for r, v in zip(self._ranges, magnitudes, strict=True)}

    def _told(self, index: int) -> str:
        r, unit = self._ranges[index], self._units[index]
        lowest, highest = self._extremes[index]
        if r.below == -r.above:  # a magnitude
            reached, limit = max(-lowest, highest), r.above
        else:
            reached, limit = (highest, r.above) if highest > r.above else (lowest, r.below)
        return f"limit tripped: {r.channel} reached {reached:.4g} {unit}, the limit is {limit:g} {unit}"


@compiled
def _scan(values, columns, ends, allowed, extremes, beyond):  # type: ignore[no-untyped-def]
    """Update extremes and samples beyond the limit; index of a tripped range or -1."""
    tripped = -1
    for entry in range(columns.shape[0]):
        for sample in range(values.shape[0]):
            value = values[sample, columns[entry]]
            if np.isnan(value):  # a device that does not know its value is not known to be within the limit
                value = np.inf
            extremes[entry, 0] = min(extremes[entry, 0], value)
            extremes[entry, 1] = max(extremes[entry, 1], value)
            inside = ends[entry, 0] <= value <= ends[entry, 1]
            # Nothing is above an open end, but what is not known is not within either.
            if inside and not np.isinf(value):
                beyond[entry] = 0
            else:
                beyond[entry] += 1
            if beyond[entry] > allowed[entry]:
                tripped = entry
    return tripped
