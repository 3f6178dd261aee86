"""The ranges of one stream's channels, looked at sample by sample."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from drivers import Samples, Stream
from hil.core.channels import CHANNELS
from hil.core.result import LimitResult
from hil.core.runtime.compiled import compiled
from hil.engine.bench.ranges import Range, slope_unit
from test_plans import Array


class StreamRanges:
    """Counts samples beyond each range; a range is reached when there are more than its persistence.

    A value that is not known (NaN) is beyond. What has been counted is forgotten once a value is inside by
    the hysteresis; one that is inside, but not so far, neither counts nor forgives.
    """

    def __init__(self, stream: Stream, ranges: list[Range]) -> None:
        self.ranges = [r for r in ranges if r.channel in stream.channels]
        places = [stream.channels.index(r.channel) for r in self.ranges]
        self._units = [
            r.unit or _unit(stream, place, r) for r, place in zip(self.ranges, places, strict=True)
        ]
        self._slopes = [
            _Slope(place, max(1, round(r.slope_s / stream.period_s)), stream.period_s)
            for r, place in zip(self.ranges, places, strict=True)
            if r.slope_s is not None
        ]
        behind = iter(range(len(stream.channels), len(stream.channels) + len(self._slopes)))
        columns = [
            place if r.slope_s is None else next(behind) for r, place in zip(self.ranges, places, strict=True)
        ]
        self._columns = np.array(columns, np.int64)
        self._ends = np.array(
            [(r.below, r.above, r.below + r.hysteresis, r.above - r.hysteresis) for r in self.ranges]
        ).reshape(-1, 4)
        self._allowed = np.array([r.samples(stream.period_s) for r in self.ranges], np.int64)
        self._extremes = np.zeros((len(self.ranges), 2))
        #: Samples beyond; how often it was reached; whether it was in the samples looked at last.
        self._counts = np.zeros((len(self.ranges), 3), np.int64)
        self._answered = np.zeros(len(self.ranges), np.int64)
        self._any = False

    def look(self, samples: Samples) -> bool:
        """Whether any range is reached in these samples."""
        if not self.ranges:
            return False
        values = samples.values
        if self._slopes:
            values = np.column_stack([values, *(slope.of(values) for slope in self._slopes)])
        if not self._any:
            self._any = True
            self._extremes[:] = np.nan_to_num(values[:1, self._columns].T, nan=np.inf)
        return bool(_scan(values, self._columns, self._ends, self._allowed, self._extremes, self._counts))

    def reached(self) -> Iterator[tuple[Range, str]]:
        """What to answer to, with words for each: a trip as long as it stands, others once each time."""
        for entry in np.flatnonzero(self._counts[:, 2]).tolist():
            range_ = self.ranges[entry]
            if range_.response == "trip" or self._counts[entry, 1] > self._answered[entry]:
                self._answered[entry] = self._counts[entry, 1]
                yield range_, self._in_words(entry)

    def stands(self) -> Iterator[tuple[Range, str]]:
        """Ranges that were reached and have not been left again."""
        for entry in np.flatnonzero(self._counts[:, 0] > self._allowed).tolist():
            yield self.ranges[entry], self._in_words(entry)

    def largest(self) -> dict[str, float]:
        """Largest magnitude of each channel so far."""
        magnitudes = np.max(np.abs(self._extremes), axis=1)
        pairs = zip(self.ranges, magnitudes, strict=True)
        return {r.channel: float(v) for r, v in pairs if r.slope_s is None}

    def results(self) -> Iterator[LimitResult]:
        """Each range with what was reached."""
        for r, unit, extremes, counts in zip(
            self.ranges, self._units, self._extremes, self._counts, strict=True
        ):
            lowest, highest = (round(float(v), 6) if self._any and np.isfinite(v) else None for v in extremes)
            yield LimitResult(
                name=r.name,
                channel=r.channel,
                of="value" if r.slope_s is None else "slope",
                unit=unit,
                below=r.below if np.isfinite(r.below) else None,
                above=r.above if np.isfinite(r.above) else None,
                hysteresis=r.hysteresis,
                persistence_s=None if r.persistence_samples is not None else r.persistence_s,
                persistence_samples=r.persistence_samples,
                response=r.response,
                lowest=lowest,
                highest=highest,
                reached=int(counts[1]),
            )

    def _in_words(self, entry: int) -> str:
        r, unit = self.ranges[entry], self._units[entry]
        lowest, highest = self._extremes[entry]
        if r.below == -r.above:  # a magnitude
            reached, limit = max(-lowest, highest), r.above
        else:
            reached, limit = (highest, r.above) if highest > r.above else (lowest, r.below)
        return f"{r.what} reached {reached:.4g} {unit}, the limit is {limit:g} {unit}"


class _Slope:
    """The slope of one column over a number of samples, units a second."""

    def __init__(self, column: int, over: int, period_s: float) -> None:
        self._column, self._over, self._time_s = column, over, over * period_s
        self._before: Array | None = None

    def of(self, values: Array) -> Array:
        """At each sample, shape (n,); 0 until there are enough of them, NaN next to what is not known."""
        own = values[:, self._column]
        if self._before is None and len(own):
            self._before = np.full(self._over, own[0])
        if self._before is None:
            return np.zeros(0)
        known = np.concatenate([self._before, own])
        self._before = known[-self._over :]
        slope: Array = (known[self._over :] - known[: -self._over]) / self._time_s
        return slope


def _unit(stream: Stream, place: int, range_: Range) -> str:
    unit = unit_of(stream.channels[place], stream.units[place])
    return unit if range_.slope_s is None else slope_unit(unit)


def unit_of(channel: str, stated: str) -> str:
    """A channel's unit; of one that is not ours what its device says."""
    return stated or (CHANNELS[channel].unit if channel in CHANNELS else "")


@compiled
def _scan(values, columns, ends, allowed, extremes, counts):  # type: ignore[no-untyped-def]
    """Update extremes and counts; whether any range is reached in one of the samples."""
    any_reached = False
    for entry in range(columns.shape[0]):
        counts[entry, 2] = 0
        for sample in range(values.shape[0]):
            value = values[sample, columns[entry]]
            if np.isnan(value):  # a device that does not know its value is not known to be within the limit
                value = np.inf
            extremes[entry, 0] = min(extremes[entry, 0], value)
            extremes[entry, 1] = max(extremes[entry, 1], value)
            inside = ends[entry, 0] <= value <= ends[entry, 1]
            # Nothing is above an open end, but what is not known is not within either.
            if not inside or np.isinf(value):
                counts[entry, 0] += 1
                if counts[entry, 0] == allowed[entry] + 1:
                    counts[entry, 1] += 1
            elif ends[entry, 2] <= value <= ends[entry, 3]:
                counts[entry, 0] = 0
            if counts[entry, 0] > allowed[entry]:
                counts[entry, 2] = 1
                any_reached = True
    return any_reached
