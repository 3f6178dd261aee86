"""When a device took its samples: a line of arrival times over sample numbers that no late frame bends."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]

_STRETCH = 200  # samples of which the earliest arrival counts: the others were held up on their way
_STRETCHES = 32  # stretches that the line goes through
_FEW = 8  # stretches below which their spread is not known yet
_FOR_SLOPE = 4  # stretches below which the device's clock is taken for as fast as the bench's
_PART = 25  # samples of a stretch that are looked at on their own while there are few stretches
_LARGEST_DRIFT = 1e-3  # quartz is off by a tenth of it at most
_BEFORE = 3  # stretches before these that say where it lay
_STEPPED = 15  # stretches in succession that lie aside before two clocks count as parted


@dataclass(frozen=True)
class ClockFigures:
    """A device's clock against another: `offset_s` at its newest sample, positive if late."""

    offset_s: float
    drift_ppm: float


class SampleClock:
    """The time of each sample number, on the bench clock.

    Frames come late, in bunches or after a pause, but none comes before it was sent. So of each stretch of
    `_STRETCH` samples only the earliest arrival is looked at, and a line through the newest `_STRETCHES` of
    these, by medians (H. Theil 1950, P. K. Sen 1968), gives a sample's time. What is constant in the way
    from device to bench cannot be distinguished from a clock that is off, and stays in the times.
    """

    def __init__(self, period_s: float) -> None:
        self.period_s = period_s
        self._origin: tuple[int, float] | None = None
        self._stretches = array("d")  # place and delay of each, both against the origin: a run has very many
        self._newest = np.zeros((0, 2))
        self._open = np.array([0.0, np.inf, 0.0])  # samples of the stretch so far, its least delay and place
        self._slope, self._level_s = 0.0, 0.0  # delay = level + slope * (number - origin)
        self._parts: list[float] = []  # least delays of the first parts
        self.spread_s = 0.0
        self.latest_s = 0.0

    @property
    def started(self) -> bool:
        """Whether it has seen anything."""
        return self._origin is not None

    @property
    def _known(self) -> int:
        """How many stretches are whole."""
        return len(self._stretches) // 2

    def guess(self, numbers: Numbers, arrival_times_s: Array) -> None:
        """Begin with numbers that may yet turn out to lack some."""
        self._origin = (int(numbers[0]), float(arrival_times_s[0]))
        self._level_s = float(np.min(self._delays(numbers, arrival_times_s)[:_STRETCH]))

    def learn(self, numbers: Numbers, arrival_times_s: Array) -> None:
        """Take the arrival times (s, bench clock) of samples, in any order."""
        if not len(numbers):
            return
        if self._origin is None:
            self._origin = (int(numbers[0]), float(arrival_times_s[0]))
        number, time_s = self._origin
        if self._known <= _FEW:
            delays = self._delays(numbers, arrival_times_s)
            self._parts += [float(np.min(delays[at : at + _PART])) for at in range(0, len(delays), _PART)]
        found = np.empty((len(numbers) // _STRETCH + 1, 2))
        known = self._known > 0
        count, late_s = _least(
            numbers, arrival_times_s, number, time_s, self.period_s, self._slope, self._open, found
        )
        if known:
            self.latest_s = max(self.latest_s, late_s - self._level_s)
        if count:
            self._stretches.frombytes(found[:count].tobytes())
            self._newest = np.concatenate([self._newest, found[:count]])[-_STRETCHES:]
        if count or self._known < _FEW:
            self._fit()

    def times(self, numbers: Numbers) -> Array:
        """Bench time of samples, s, shape as given."""
        assert self._origin is not None
        number, time_s = self._origin
        since = (numbers - number).astype(np.float64)
        return np.asarray(time_s + self._level_s + since * (self.period_s + self._slope))

    def numbers_at(self, times_s: Array) -> Array:
        """Sample numbers at bench times, s, shape as given; fractions between two samples."""
        assert self._origin is not None
        number, origin_s = self._origin
        return np.asarray(number + (times_s - origin_s - self._level_s) / (self.period_s + self._slope))

    def number_at(self, time_s: float) -> float:
        """Sample number at one bench time."""
        return float(self.numbers_at(np.array([time_s]))[0])

    def against(self, base: SampleClock | None) -> ClockFigures:
        """This clock against another (None: the bench's); whole sample times are for the count to tell."""
        if self._origin is None:
            return ClockFigures(0.0, 0.0)
        if base is None:
            return ClockFigures(0.0, self._whole_drift() * 1e6)
        newest = self._origin[0] + (round(self._stretches[-2]) if self._stretches else 0)
        aside = base.number_at(float(self.times(np.array([newest]))[0]))
        offset_s = (aside - round(aside)) * base.period_s
        return ClockFigures(offset_s, (self._whole_drift() - base._whole_drift()) * 1e6)

    @property
    def disorder(self) -> float:
        """How badly numbers and arrival times agree: offset of a stretch from the bench's clock, samples."""
        return abs(self._slope) / self.period_s * _STRETCH + self.spread_s / self.period_s

    def parted_from(self, base: SampleClock | None) -> str:
        """What to say if this clock and another (None: the bench's) have parted; else nothing."""
        drift = (self._slope - (base._slope if base else 0.0)) / self.period_s
        known = self._known >= _STRETCHES
        if known and abs(drift) > _LARGEST_DRIFT and self.spread_s < self.period_s:
            return f"its samples come {abs(drift) * 1e6:.0f} ppm too {'slow' if drift > 0 else 'fast'}"
        if base is None or min(self._known, base._known) < _STEPPED + _BEFORE:
            return ""
        aside = self._aside() - base._aside()
        room_s = self.period_s + 2 * (self.spread_s + base.spread_s)
        if np.all(aside > room_s) or np.all(aside < -room_s):
            lie = f"{abs(float(np.median(aside))) * 1e3:.1f} ms {'later' if aside[0] > 0 else 'earlier'}"
            return f"its samples come {lie} than their number says"
        return ""

    def _aside(self) -> Array:
        """How far the newest stretches lie beside the line through those before, s."""
        places, delays = self._newest.T
        beside = delays - self._slope * places
        return np.asarray(beside[-_STEPPED:] - np.median(beside[:-_STEPPED]))

    def _delays(self, numbers: Numbers, arrival_times_s: Array) -> Array:
        assert self._origin is not None
        number, time_s = self._origin
        return np.asarray((arrival_times_s - time_s) - (numbers - number) * self.period_s)

    def _fit(self) -> None:
        if not self._stretches:
            self._level_s = float(self._open[1])
            self.spread_s = float(_spread(np.array(self._parts)))
            return
        places, delays = self._newest.T
        self._slope, self._level_s, self.spread_s = _line(places, delays, len(places) >= _FOR_SLOPE)
        if len(places) < _FEW:  # what is not known yet is not taken for little
            self.spread_s = max(self.spread_s, _spread(np.array(self._parts)))

    def _whole_drift(self) -> float:
        """Of the whole run, as a share."""
        if self._known < _FOR_SLOPE:
            return 0.0
        places, delays = np.array(self._stretches).reshape(-1, 2)[:: self._known // 200 + 1].T
        return float(_slope(places, delays)) / self.period_s


@compiled
def _least(numbers, arrival_times, number, time_s, period_s, slope, state, found):  # type: ignore[no-untyped-def]
    """Place and delay of the earliest sample of each stretch; how many are whole, and the longest delay."""
    count, longest = 0, -np.inf
    for i in range(len(numbers)):
        place = np.float64(numbers[i] - number)
        delay = (arrival_times[i] - time_s) - place * period_s
        longest = max(longest, delay - slope * place)
        state[0] += 1
        if delay < state[1]:
            state[1], state[2] = delay, place
        if state[0] == _STRETCH:
            found[count, 0], found[count, 1] = state[2], state[1]
            state[0], state[1] = 0.0, np.inf
            count += 1
    return count, longest


# By sorting: loading compiled medians would take longer than all fits of a run.
def _median(values: Array) -> float:
    ordered = np.sort(values)
    return 0.5 * float(ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2])


def _spread(least: Array) -> float:
    """By how much least delays vary; a few that were held up altogether do not count."""
    ordered = np.sort(least)
    return 2.0 * (float(ordered[9 * (len(ordered) - 1) // 10]) - _median(ordered))


@cache
def _pairs(count: int) -> tuple[Numbers, Numbers]:
    return np.triu_indices(count, 1)


def _slope(places: Array, delays: Array) -> float:
    """Median of the slopes between all pairs."""
    first, second = _pairs(len(places))
    apart = places[second] - places[first]
    if not apart.all():
        first, second, apart = first[apart != 0], second[apart != 0], apart[apart != 0]
    return _median((delays[second] - delays[first]) / apart) if len(apart) else 0.0


def _line(places: Array, delays: Array, sloped: bool) -> tuple[float, float, float]:
    """Slope, level at the origin and spread of a line through delays."""
    slope = _slope(places, delays) if sloped else 0.0
    beside = delays - slope * places
    spread = _spread(beside)
    if abs(slope) * (places[-1] - places[0]) < 2 * spread:
        # The way to the bench varies by more than the clocks.
        return 0.0, _median(delays), _spread(delays)
    return slope, _median(beside), spread
