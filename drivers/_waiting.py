"""Samples of one stream that wait to stand in a row, each with its number and the time that this gives it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivers.frame_count import DOUBTFUL, PLACED, Fates, FrameCount
from drivers.sample_clock import SampleClock
from drivers.samples import Array, Numbers, Samples, Stream

_OVERTAKEN_S = 0.1  # what is missing may have been overtaken: it is awaited for this long
_SURE = 3  # spreads of two clocks by which an offset must differ to be another
_MOVED = 2.5  # samples by which rows may come to mean others at once: more is no drift
_NOTHING = np.zeros(0, np.int64)


@dataclass(frozen=True)
class StreamTiming:
    """How a stream's samples lay in time.

    `offset_s`, `drift_ppm`: its clock against the time base, for the time base against the bench's clock;
    `latest_s`: by how much the latest frame came after its time; `lost`: samples of which no frame came;
    `left_out`: frames that came, but no one can say of which sample.
    """

    stream: Stream
    offset_s: float
    drift_ppm: float
    latest_s: float
    lost: int
    left_out: int


class Waiting:
    """A stream's samples by number, in order, as far as they are certain.

    Args:
        stream: whose.
        counted: number them even if nothing but their order counts them.
        followed: the one whose frames count this one's samples.
    """

    def __init__(self, stream: Stream, *, counted: bool, followed: Waiting | None) -> None:
        self.stream = stream
        self._followed = followed
        turn = stream.counting.turn if stream.counting else 1
        self.clock = SampleClock(stream.period_s) if counted or stream.counting else None
        self.count = FrameCount(turn, self.clock) if self.clock and followed is None else None
        self.numbers: Numbers = _NOTHING
        self.stamps: Array = np.zeros(0)
        self._values: Array = np.zeros((0, len(stream.channels)))
        self.new: list[Samples] = []
        self._uncertain = (_NOTHING, np.zeros(0), self._values)  # counts, arrival times and values
        self._came = 0
        self._unwanted = 0  # of what is uncertain or new, the first are only learned from
        self.first: int | None = None
        self._written: int | None = None
        self._kept = self._left_out = 0
        # Its number less that of the time base's sample of the same moment
        self._ahead: int | None = None
        self.moved_s = 0.0  # by how much rows have come to mean other samples at once, beyond any drift

    @property
    def count_of_all(self) -> FrameCount | None:
        """What counts its samples, and maybe those of others."""
        return self._followed.count if self._followed else self.count

    @property
    def doubtful(self) -> bool:
        """Whether something has come that has no number yet."""
        return len(self._uncertain[0]) > 0

    @property
    def newest_s(self) -> float:
        """Time of the newest sample."""
        return float(self.stamps[-1]) if len(self.stamps) else -np.inf

    def learn(self, samples: Samples) -> None:
        """Take samples that are not to be kept; before any that are."""
        if self.clock:
            self.new.append(samples)
            self._unwanted += len(samples.time_s)

    def join(self, *, everything: bool = False) -> None:
        """Give what has come its numbers and times."""
        new, self.new = self.new, []
        if self.clock is None:
            if new:
                self.stamps = np.concatenate([self.stamps, *[samples.time_s for samples in new]])
                self._values = np.concatenate([self._values, *[samples.values for samples in new]])
            return
        counts, arrival_times, values = self._uncertain
        if new:
            counts = np.concatenate([counts, *[self._counts(samples) for samples in new]])
            arrival_times = np.concatenate([arrival_times, *[samples.time_s for samples in new]])
            values = np.concatenate([values, *[samples.values for samples in new]])
        numbers, fates = self._numbered(counts, arrival_times, everything)
        end = len(numbers)
        self._uncertain = counts[end:], arrival_times[end:], values[end:]
        first = min(self._unwanted, end)
        self._unwanted -= first
        numbers, fates, values = numbers[first:], fates[first:], values[first:end]
        if np.count_nonzero(fates):
            self._left_out += int(np.count_nonzero(fates == DOUBTFUL))
            kept = fates == PLACED
            numbers, values = numbers[kept], values[kept]
        self._keep(numbers, values)
        if len(self.numbers):
            self.stamps = self.clock.times(self.numbers)

    def _counts(self, samples: Samples) -> Numbers:
        if samples.counts is not None:
            return samples.counts
        self._came += len(samples.time_s)
        return np.arange(self._came - len(samples.time_s), self._came)

    def _numbered(self, counts: Numbers, arrival_times: Array, everything: bool) -> tuple[Numbers, Fates]:
        assert self.clock is not None
        if self.count:
            return self.count.settle(counts, arrival_times, everything=everything)
        assert self._followed is not None
        assert self._followed.count is not None
        assert self.stream.counting is not None
        numbers, fates = self._followed.count.follow(counts, opens=self.stream.counting.opens)
        arrival_times = arrival_times[: len(numbers)]
        if np.count_nonzero(fates):
            placed = fates == PLACED
            self.clock.learn(numbers[placed], arrival_times[placed])
        else:
            self.clock.learn(numbers, arrival_times)
        return numbers, fates

    def _keep(self, numbers: Numbers, values: Array) -> None:
        """Put them among those that wait, each number once; what has been written stays as it is."""
        if not len(numbers):
            return
        if self.first is None:
            self.first = int(np.min(numbers))
        last = self._written if self._written is not None else self.first - 1
        if numbers[0] <= last:
            fresh = numbers > last
            numbers, values = numbers[fresh], values[fresh]
        before = len(self.numbers)
        if before:
            numbers = np.concatenate([self.numbers, numbers])
            values = np.concatenate([self._values, values])
        if np.any(numbers[1:] <= numbers[:-1]):
            numbers, first = np.unique(numbers, return_index=True)
            values = values[first]
            if numbers[0] <= last:  # overtaken by what has been written
                fresh = numbers > last
                numbers, values = numbers[fresh], values[fresh]
        self._kept += len(numbers) - before
        self.numbers, self._values = numbers, values

    def certain(self) -> int:
        """How many there are before one that may yet come."""
        if len(self.numbers) < 2 or self.numbers[-1] - self.numbers[0] == len(self.numbers) - 1:
            return len(self.numbers)
        young = self.stamps[1:] > self.newest_s - _OVERTAKEN_S
        missing = np.flatnonzero((np.diff(self.numbers) > 1) & young)
        return int(missing[0]) + 1 if len(missing) else len(self.numbers)

    def timing(self, base: Waiting) -> StreamTiming | None:
        """How its samples lay in time; None if they were not counted, or none came."""
        if self.clock is None or self.first is None or base.clock is None:
            return None
        newest = int(self.numbers[-1]) if len(self.numbers) else self._written
        numbers = (newest if newest is not None else self.first) - self.first + 1
        lost = max(0, numbers - self._kept - self._left_out)
        figures = self.clock.against(None if self is base else base.clock)
        return StreamTiming(
            self.stream, figures.offset_s, figures.drift_ppm, self.clock.latest_s, lost, self._left_out
        )

    def nearest(self, stamps: Array, within_s: float) -> Array:
        """For each stamp the sample nearest to it, (len(stamps), channels); NaN where none is near enough."""
        if not len(self.stamps):
            return np.full((len(stamps), self._values.shape[1]), np.nan)
        at = _nearest(self.stamps, stamps)
        found = self._values[at]
        found[np.abs(self.stamps[at] - stamps) > within_s] = np.nan
        return found

    def paired(self, base: Waiting, count: int, within: float) -> Array:
        """For each of the time base's first `count` samples the one of the same moment, or its neighbour.

        Both count alike, so which belongs to which only changes as their clocks drift: an offset that is not
        known to be another stays. NaN where none is nearer than `within` sample times.
        """
        if not len(self.numbers) or self.clock is None or base.clock is None:
            return np.full((count, self._values.shape[1]), np.nan)
        numbers = base.numbers[:count]
        if self.count_of_all is base.count_of_all:
            return self._numbered_as(numbers, within)
        ahead = self.clock.numbers_at(base.stamps[:count]) - numbers
        room = 0.5 + _SURE * (self.clock.spread_s + base.clock.spread_s) / self.stream.period_s
        if self._ahead is None or np.max(np.abs(ahead - self._ahead)) > room:
            wanted = numbers + np.rint(ahead).astype(np.int64)
            self._note_moved(int(wanted[-1] - numbers[-1]))
        else:
            wanted = numbers + self._ahead
        return self._numbered_as(wanted, within)

    def _note_moved(self, ahead: int) -> None:
        if self._ahead is not None and abs(ahead - self._ahead) > _MOVED:
            self.moved_s = (ahead - self._ahead) * self.stream.period_s
        self._ahead = ahead

    def _numbered_as(self, wanted: Numbers, within: float) -> Array:
        first = int(wanted[0] - self.numbers[0])
        last = first + len(wanted)
        if first >= 0 and last <= len(self.numbers) and np.array_equal(self.numbers[first:last], wanted):
            return self._values[first:last]
        at = _nearest(self.numbers, wanted)
        found = self._values[at]
        found[np.abs(self.numbers[at] - wanted) > within] = np.nan
        return found

    def placed(self, stamps: Array, within_s: float, reach_s: float) -> tuple[Array, int]:
        """Each sample at the stamp nearest to it, NaN elsewhere; and how many came after their row.

        Takes away what has been placed; what lies more than `reach_s` behind the last stamp goes on waiting.
        """
        found = np.full((len(stamps), self._values.shape[1]), np.nan)
        due = int(np.searchsorted(self.stamps, stamps[-1] + reach_s, side="right"))
        times = self.stamps[:due]
        at = _nearest(stamps, times)
        near = np.abs(stamps[at] - times) <= within_s
        found[at[near]] = self._values[:due][near]
        self._drop(due)
        return found, int(np.sum(times[~near] < stamps[0]))

    def forget(self, before_s: float) -> None:
        """Let go of what no later row needs."""
        self._drop(int(np.searchsorted(self.stamps, before_s)))

    def _drop(self, count: int) -> None:
        if self.clock and count:
            self._written = int(self.numbers[count - 1])
            self.numbers = self.numbers[count:]
        self.stamps, self._values = self.stamps[count:], self._values[count:]


def _nearest(places: Array | Numbers, times: Array | Numbers) -> Numbers:
    """Index of the place nearest to each time; of two as near the earlier."""
    after = np.clip(np.searchsorted(places, times), 0, len(places) - 1)
    before = np.maximum(after - 1, 0)
    closer = np.abs(places[before] - times) <= np.abs(places[after] - times)
    return np.where(closer, before, after)
