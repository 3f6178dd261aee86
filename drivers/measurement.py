"""From frames to channels: rows of samples on the RMCU's time base."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import TIME
from hil.core.frames import FrameBlock, joined, standard
from hil.core.signals import Signal

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Binding:
    """A signal of a frame on a bus that gives a channel."""

    bus: str
    frame_id: int
    signal: Signal
    channel: str


# Channels that are computed from both sides: (name, left, right, sum instead of mean)
_BOTH_SIDES = (
    ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s", False),
    ("shaft_torque_nm", "shaft_torque_left_nm", "shaft_torque_right_nm", True),
    ("dyno_torque_ref_nm", "dyno_torque_left_nm", "dyno_torque_right_nm", True),
)
_NEAREST_WITHIN = 2.5  # sample times; beyond, a value is missing (NaN)
_SETTLED_S = 0.003  # frames older than this, before the newest of the slowest bus, have all arrived
_GIVEN_UP_S = 0.1  # a stream that is silent for this long holds up nobody


class SampleAssembler:
    """Puts the frames of all buses together into samples.

    The first binding's frame is the time base: each of its frames is one sample, and `time_s` counts
    sample times from the first (a lost frame leaves a gap). Every other channel takes the frame nearest
    in time, which is the one of the same millisecond where the devices' clocks agree to half a sample.
    """

    def __init__(self, bindings: Sequence[Binding], sample_time_s: float) -> None:
        self._bindings = list(bindings)
        self._sample_time_s = sample_time_s
        self._keys = sorted({(b.bus, b.frame_id) for b in bindings})
        self._master = (bindings[0].bus, bindings[0].frame_id)
        self._blocks: dict[str, list[FrameBlock]] = {bus: [] for bus in {b.bus for b in bindings}}
        self._waiting = {key: _Stream() for key in self._keys}
        self._count = 0
        self._last_stamp_s: float | None = None
        measured = [b.channel for b in bindings]
        derived = [name for name, left, right, _ in _BOTH_SIDES if left in measured and right in measured]
        self.names = [TIME, *measured, *derived]

    def add(self, bus: str, block: FrameBlock) -> None:
        """Take the frames of one bus."""
        if bus in self._blocks:
            self._blocks[bus].append(standard(block))

    def rows(self, *, everything: bool = False) -> Array:
        """Samples that are complete (`everything`: also the newest), one row each, columns as `names`."""
        self._sort_in()
        master = self._waiting[self._master]
        count = len(master.stamps)
        if not everything:
            # The buses are drained one after the other: wait for the slowest, but not for a dead one.
            oldest_s = min(max(s.newest_s, master.newest_s - _GIVEN_UP_S) for s in self._waiting.values())
            count = int(np.searchsorted(master.stamps, oldest_s - _SETTLED_S))
        if count <= 0:
            return np.zeros((0, len(self.names)))
        stamps = master.stamps[:count]
        columns: dict[str, Array] = {TIME: self._sample_times(stamps)}
        for key, stream in self._waiting.items():
            at = stream.nearest(stamps, _NEAREST_WITHIN * self._sample_time_s)
            for binding in self._bindings:
                if (binding.bus, binding.frame_id) == key:
                    columns[binding.channel] = stream.values(binding.signal, at)
        for name, left, right, is_sum in _BOTH_SIDES:
            if name in self.names:
                both = columns[left] + columns[right]
                columns[name] = both if is_sum else 0.5 * both
        for stream in self._waiting.values():
            stream.forget(
                stamps[-1] - _SETTLED_S if stream is not master else np.nextafter(stamps[-1], np.inf)
            )
        return np.column_stack([columns[name] for name in self.names])

    def _sort_in(self) -> None:
        for bus, blocks in self._blocks.items():
            if not blocks:
                continue
            block = joined(blocks)
            self._blocks[bus] = []
            for key in self._keys:
                if key[0] == bus:
                    self._waiting[key].extend(block[block["id"] == key[1]])

    def _sample_times(self, stamps: Array) -> Array:
        previous = stamps[0] - self._sample_time_s if self._last_stamp_s is None else self._last_stamp_s
        steps = np.rint(np.diff(stamps, prepend=previous) / self._sample_time_s)
        numbers = self._count + np.cumsum(np.maximum(1, steps).astype(np.int64))
        self._count, self._last_stamp_s = int(numbers[-1]), float(stamps[-1])
        return np.round((numbers - 1) * self._sample_time_s, 9)


class _Stream:
    """Frames of one identifier that wait to become samples."""

    def __init__(self) -> None:
        self.stamps: Array = np.zeros(0)
        self._payloads: npt.NDArray[np.uint64] = np.zeros(0, np.uint64)

    @property
    def newest_s(self) -> float:
        return float(self.stamps[-1]) if len(self.stamps) else -np.inf

    def extend(self, block: FrameBlock) -> None:
        self.stamps = np.concatenate([self.stamps, block["time_s"]])
        self._payloads = np.concatenate([self._payloads, block["data"]])

    def nearest(self, stamps: Array, within_s: float) -> npt.NDArray[np.int64]:
        """Index of the frame nearest to each stamp; -1 where none is near enough."""
        if not len(self.stamps):
            return np.full(len(stamps), -1)
        after = np.clip(np.searchsorted(self.stamps, stamps), 0, len(self.stamps) - 1)
        before = np.maximum(after - 1, 0)
        closer = np.abs(self.stamps[before] - stamps) <= np.abs(self.stamps[after] - stamps)
        at = np.where(closer, before, after)
        return np.where(np.abs(self.stamps[at] - stamps) <= within_s, at, -1)

    def values(self, signal: Signal, at: npt.NDArray[np.int64]) -> Array:
        if not len(self._payloads):
            return np.full(len(at), np.nan)
        return np.where(at >= 0, signal.decode(self._payloads[at]), np.nan)

    def forget(self, before_s: float) -> None:
        keep = int(np.searchsorted(self.stamps, before_s))
        self.stamps, self._payloads = self.stamps[keep:], self._payloads[keep:]
