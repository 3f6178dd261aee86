"""From samples to channels: rows on the time base of the RMCU, whoever measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from drivers.samples import Array, Samples, Stream
from hil.core.channels import TIME

# Channels that are computed from both sides: (name, left, right, sum instead of mean)
_BOTH_SIDES = (
    ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s", False),
    ("shaft_torque_nm", "shaft_torque_left_nm", "shaft_torque_right_nm", True),
    ("dyno_torque_ref_nm", "dyno_torque_left_nm", "dyno_torque_right_nm", True),
)
_NEAREST_WITHIN = 2.5  # sample times; beyond, a value is missing (NaN)
_GIVEN_UP_S = 0.1  # a stream that is silent for this long holds up nobody
_SLOWER = 1.5  # sample times; a stream slower than this leaves rows without a value


class SampleAssembler:
    """Puts the samples of all streams together into rows.

    The first stream is the time base: each of its samples is one row, and `time_s` counts sample times from
    the first (a lost frame leaves a gap). A stream of the same rate gives each row its sample nearest in
    time, which is the one of the same millisecond where the devices' clocks agree to half a sample. A sample
    of a slower stream stands once, in the row nearest to it: the rows between have no value (NaN), for none
    was measured. Of a faster stream each row has the sample nearest to it.

    `late` counts samples of slower streams that came after their row was written; they are left out.
    """

    def __init__(self, streams: Sequence[Stream], sample_time_s: float) -> None:
        self._sample_time_s = sample_time_s
        self._waiting: dict[Stream, _Waiting] = {stream: _Waiting(stream) for stream in streams}
        self._base = self._waiting[streams[0]]
        self._slow = [w for w in self._waiting.values() if w.stream.period_s > _SLOWER * sample_time_s]
        self._even = [w for w in self._waiting.values() if w not in self._slow]
        self._count = 0
        self._last_stamp_s: float | None = None
        self.late = 0
        measured = [channel for stream in streams for channel in stream.channels]
        derived = [name for name, left, right, _ in _BOTH_SIDES if left in measured and right in measured]
        self.names = [TIME, *measured, *derived]

    def add(self, samples: Samples) -> None:
        """Take samples of a stream."""
        self._waiting[samples.stream].extend(samples)

    def rows(self, *, everything: bool = False) -> Array:
        """Samples that are complete (`everything`: also the newest), one row each, columns as `names`."""
        for waiting in self._waiting.values():
            waiting.join()
        count = len(self._base.stamps) if everything else self._complete()
        if count <= 0:
            return np.zeros((0, len(self.names)))
        stamps = self._base.stamps[:count]
        begun = self._count > 0
        columns: dict[str, Array] = {TIME: self._sample_times(stamps)}
        within_s = _NEAREST_WITHIN * self._sample_time_s
        for waiting in self._waiting.values():
            if waiting in self._slow:
                values, late = waiting.placed(stamps, within_s, 0.5 * self._sample_time_s)
                self.late += late if begun else 0
            else:
                values = waiting.nearest(stamps, within_s)
            columns |= dict(zip(waiting.stream.channels, values.T, strict=True))
        for name, left, right, is_sum in _BOTH_SIDES:
            if name in self.names:
                both = columns[left] + columns[right]
                columns[name] = both if is_sum else 0.5 * both
        for waiting in self._even:
            last_s = stamps[-1] - waiting.stream.late_s
            waiting.forget(np.nextafter(stamps[-1], np.inf) if waiting is self._base else last_s)
        return np.column_stack([columns[name] for name in self.names])

    def _complete(self) -> int:
        """How many rows can be written: what may still come is awaited, but not from a dead device."""
        newest_s = self._base.newest_s
        until_s = [max(w.newest_s, newest_s - _GIVEN_UP_S) - w.stream.late_s for w in self._even]
        # Between two samples of a slow stream nothing can be awaited but that the next one comes late.
        # The row that it is nearest to may be the one before it.
        until_s += [newest_s - w.stream.late_s - 0.5 * self._sample_time_s for w in self._slow]
        return int(np.searchsorted(self._base.stamps, min(until_s)))

    def _sample_times(self, stamps: Array) -> Array:
        previous = stamps[0] - self._sample_time_s if self._last_stamp_s is None else self._last_stamp_s
        steps = np.rint(np.diff(stamps, prepend=previous) / self._sample_time_s)
        numbers = self._count + np.cumsum(np.maximum(1, steps).astype(np.int64))
        self._count, self._last_stamp_s = int(numbers[-1]), float(stamps[-1])
        return np.round((numbers - 1) * self._sample_time_s, 9)


class _Waiting:
    """Samples of one stream that wait to stand in a row."""

    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self.stamps: Array = np.zeros(0)
        self._values: Array = np.zeros((0, len(stream.channels)))
        self._new: list[Samples] = []

    @property
    def newest_s(self) -> float:
        return float(self.stamps[-1]) if len(self.stamps) else -np.inf

    def extend(self, samples: Samples) -> None:
        self._new.append(samples)

    def join(self) -> None:
        if self._new:
            self.stamps = np.concatenate([self.stamps, *(new.time_s for new in self._new)])
            self._values = np.concatenate([self._values, *(new.values for new in self._new)])
            self._new = []

    def nearest(self, stamps: Array, within_s: float) -> Array:
        """For each stamp the sample nearest to it, (len(stamps), channels); NaN where none is near enough."""
        if not len(self.stamps):
            return np.full((len(stamps), self._values.shape[1]), np.nan)
        at = _nearest(self.stamps, stamps)
        found = self._values[at]
        found[np.abs(self.stamps[at] - stamps) > within_s] = np.nan
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
        self.stamps, self._values = self.stamps[due:], self._values[due:]
        return found, int(np.sum(times[~near] < stamps[0]))

    def forget(self, before_s: float) -> None:
        keep = int(np.searchsorted(self.stamps, before_s))
        self.stamps, self._values = self.stamps[keep:], self._values[keep:]


def _nearest(places: Array, times: Array) -> npt.NDArray[np.int64]:
    """Index of the place nearest to each time; of two as near the earlier."""
    after = np.clip(np.searchsorted(places, times), 0, len(places) - 1)
    before = np.maximum(after - 1, 0)
    closer = np.abs(places[before] - times) <= np.abs(places[after] - times)
    return np.where(closer, before, after)
