"""From samples to channels: rows on the time base of the RMCU, whoever measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drivers._waiting import StreamTiming, Waiting
from drivers.samples import Array, Samples, Stream
from hil.core.channels import TIME
from hil.core.errors import BenchError

# Channels that are computed from both sides: (name, left, right, sum instead of mean)
_BOTH_SIDES = (
    ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s", False),
    ("shaft_torque_nm", "shaft_torque_left_nm", "shaft_torque_right_nm", True),
    ("dyno_torque_ref_nm", "dyno_torque_left_nm", "dyno_torque_right_nm", True),
)
_NEAREST_WITHIN = 2.5  # sample times; beyond, a value is missing (NaN)
_GIVEN_UP_S = 0.1  # a stream that is silent for this long holds up no one
_SLOWER = 1.5  # sample times; a stream slower than this leaves rows without a value


def _nothing() -> None:
    """What most callers have to do between parts."""


class SampleAssembler:
    """Puts the samples of all streams together into rows.

    The first stream is the time base: each of its samples is one row, and `time_s` counts sample times from
    the first by the samples' numbers (a lost one leaves a gap). A stream of the same rate gives each row its
    sample nearest in time; of counted streams that is the time that number and clock give, not the arrival,
    so it is the one of the same millisecond where the devices' clocks agree to half a sample. A sample of a
    slower stream stands once, in the row nearest to it: the rows between have no value (NaN), for none was
    measured. Of a faster stream each row has the sample nearest to it.

    `late` counts samples of slower streams that came after their row was written; they are left out.
    """

    def __init__(self, streams: Sequence[Stream], sample_time_s: float) -> None:
        self._sample_time_s = sample_time_s
        self._waiting: dict[Stream, Waiting] = {}
        for stream in sorted(streams, key=_follows):  # who is followed comes first
            followed = stream.counting.follows if stream.counting else None
            self._waiting[stream] = Waiting(
                stream, counted=stream is streams[0], followed=self._waiting[followed] if followed else None
            )
        self._base = self._waiting[streams[0]]
        self._slow = [w for w in self._waiting.values() if w.stream.period_s > _SLOWER * sample_time_s]
        self._even = [w for w in self._waiting.values() if w not in self._slow and w.stream.channels]
        # A stream without channels of its own is there for its count, and is forgotten like the others
        self._passing = [w for w in self._waiting.values() if w not in self._slow]
        self._alike = [w for w in self._even if w.clock and w.stream.period_s == streams[0].period_s]
        self._begun = False
        self.late = 0
        measured = [channel for stream in streams for channel in stream.channels]
        derived = [name for name, left, right, _ in _BOTH_SIDES if left in measured and right in measured]
        self.names = [TIME, *measured, *derived]

    def learn(self, samples: Samples) -> None:
        """Take samples that no row needs, for the devices' clocks; not after `add`."""
        self._waiting[samples.stream].learn(samples)

    def add(self, samples: Samples) -> None:
        """Take samples of a stream."""
        self._waiting[samples.stream].new.append(samples)

    def time_of(self, clock_s: float) -> float | None:
        """What `time_s` is at a time of the bench clock, by the time base's clock; None before its first row.

        It can be negative, and between rows.
        """
        base = self._base
        if base.first is None:
            self._join()
        if base.first is None or base.clock is None:
            return None
        return (base.clock.number_at(clock_s) - base.first) * self._sample_time_s

    def bench_time_s(self, time_s: float) -> float | None:
        """The bench clock's time at a `time_s`; None before the first row."""
        base = self._base
        if base.first is None or base.clock is None:
            return None
        return float(base.clock.times(np.array([base.first]))[0]) + time_s

    def timings(self) -> list[StreamTiming]:
        """How the samples of each counted stream lay in time; the time base first."""
        others = [waiting for waiting in self._waiting.values() if waiting is not self._base]
        found = [waiting.timing(self._base) for waiting in (self._base, *others)]
        return [timing for timing in found if timing is not None]

    def look_for_parted_clocks(self) -> None:
        """Raises:
        BenchError: the count of a device's samples and their arrival do not go together any more.
        """
        base = self._base
        for waiting in [base, *(one for one in self._waiting.values() if one is not base)]:
            if waiting.clock is None:
                continue
            text = waiting.clock.parted_from(None if waiting is self._base else self._base.clock)
            if waiting.count and waiting.count.stepped_s:
                text = f"a gap is {waiting.count.stepped_s * 1e3:.1f} ms off a whole number of samples"
            if waiting.moved_s:
                text = f"its samples and the rows have moved by {abs(waiting.moved_s) * 1e3:.0f} ms at once"
            if text:
                blamed = self._less_in_time(waiting)
                if blamed is not waiting:
                    text = f"its counter deviates from the bench clock; beside {waiting.stream.label}: {text}"
                raise BenchError(
                    f"{blamed.stream.label}: {text}",
                    where=blamed.stream.where,
                    fix="check for lost frames, a restarted device, and the adapter's time stamps",
                )

    def _less_in_time(self, waiting: Waiting) -> Waiting:
        """Of a stream and the time base the one whose count goes less well with the bench's own clock."""
        base, clock = self._base, waiting.clock
        assert clock is not None
        return base if base.clock is not None and base.clock.disorder > clock.disorder else waiting

    def rows(self, *, everything: bool = False, between: Callable[[], None] = _nothing) -> Array:
        """Samples that are complete (`everything`: also the newest), one row each, columns as `names`.

        `between` is called after each part of it, for together they take longer than a millisecond; it
        may add nothing here.
        """
        self._join(everything=everything, between=between)
        base = self._base
        count = len(base.stamps) if everything else self._complete()
        if count <= 0:
            return np.zeros((0, len(self.names)))
        stamps = base.stamps[:count]
        assert base.first is not None
        times = np.round((base.numbers[:count] - base.first) * self._sample_time_s, 9)
        columns: dict[str, Array] = {TIME: times}
        within_s = _NEAREST_WITHIN * self._sample_time_s
        for waiting in self._slow:
            values, late = waiting.placed(stamps, within_s, 0.5 * self._sample_time_s)
            self.late += late if self._begun else 0
            columns |= dict(zip(waiting.stream.channels, values.T, strict=True))
        for waiting in self._even:
            if waiting in self._alike:
                values = waiting.paired(base, count, _NEAREST_WITHIN)
            else:
                values = waiting.nearest(stamps, within_s)
            columns |= dict(zip(waiting.stream.channels, values.T, strict=True))
            between()
        for name, left, right, is_sum in _BOTH_SIDES:
            if name in self.names:
                both = columns[left] + columns[right]
                columns[name] = both if is_sum else 0.5 * both
        for waiting in self._passing:
            last_s = stamps[-1] - waiting.stream.late_s
            waiting.forget(np.nextafter(stamps[-1], np.inf) if waiting is self._base else last_s)
        self._begun = True
        return np.column_stack([columns[name] for name in self.names])

    def _join(self, *, everything: bool = False, between: Callable[[], None] = _nothing) -> None:
        for waiting in self._waiting.values():
            waiting.join(everything=everything)
            between()
        for waiting in self._waiting.values():
            if waiting.count:
                waiting.count.forget()

    def _complete(self) -> int:
        """How many rows can be written: what may still come is awaited, but not from a dead device."""
        newest_s = self._base.newest_s
        given_up_s = newest_s - _GIVEN_UP_S
        until_s = [
            (w.newest_s if w.doubtful else max(w.newest_s, given_up_s)) - w.stream.late_s for w in self._even
        ]
        # Between two samples of a slow stream nothing can be awaited but that the next one comes late.
        # The row that it is nearest to may be the one before it.
        until_s += [newest_s - w.stream.late_s - 0.5 * self._sample_time_s for w in self._slow]
        return min(self._base.certain(), int(np.searchsorted(self._base.stamps, min(until_s))))


def _follows(stream: Stream) -> bool:
    return stream.counting is not None and stream.counting.follows is not None
