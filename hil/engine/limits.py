"""The bench's limits, watched on every sample of every frame, below any plan."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from drivers import Binding
from hil.core.compiled import compiled
from hil.core.errors import BenchError
from hil.core.frames import FrameBlock, standard
from hil.core.signals import double_of, single_of, swapped
from hil.engine.bench_file import Limits

_SILENCE_S = 0.1


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


class LimitWatch:
    """Trips when a channel stays beyond its limit for longer than the persistence, or falls silent."""

    def __init__(self, bindings: list[Binding], limits: Limits, sample_time_s: float) -> None:
        largest = limits_of_channels(limits)
        self._watched = [b for b in bindings if b.channel in largest]
        self._limits = np.array([largest[b.channel] for b in self._watched])
        self._allowed = max(1, round(limits.persistence_s / sample_time_s))
        self._largest = np.zeros(len(self._watched))
        self._beyond = np.zeros(len(self._watched), np.int64)
        self._seen_s = np.full(len(self._watched), -np.inf)
        self._tables = {bus: self._table(bus) for bus in {b.bus for b in self._watched}}
        self._latest_s = 0.0
        self.active = False

    @property
    def largest(self) -> dict[str, float]:
        """Largest magnitude of each watched channel so far."""
        return {b.channel: float(v) for b, v in zip(self._watched, self._largest, strict=True)}

    def take(self, bus: str, block: FrameBlock) -> None:
        """Look at the frames of one bus.

        Raises:
            BenchError: a limit tripped, or frames stopped coming.
        """
        self._latest_s = max(self._latest_s, float(block["time_s"][-1]))
        if bus not in self._tables:
            return
        block = standard(block)
        tripped = _scan(
            block["id"],
            block["time_s"],
            block["data"],
            *self._tables[bus],
            self._limits,
            self._allowed,
            self._largest,
            self._beyond,
            self._seen_s,
        )
        if self.active and tripped >= 0:
            self._trip(tripped)
        if self.active and self._latest_s - self._seen_s.min() > _SILENCE_S:
            silent = self._watched[int(np.argmin(self._seen_s))]
            raise BenchError(
                f"frame 0x{silent.frame_id:03X} ({silent.channel}) has stopped coming",
                where=f"bus '{silent.bus}'",
                fix="is the device powered?",
            )

    def _trip(self, index: int) -> None:
        binding, limit = self._watched[index], self._limits[index]
        unit = binding.signal.unit
        raise BenchError(
            f"limit tripped: {binding.channel} reached {self._largest[index]:.4g} {unit}, "
            f"the limit is {limit:g} {unit}",
            where="bench limits",
            fix="lower the plan's torque or speed; the limit is in the bench file",
        )

    def _table(self, bus: str) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64]]:
        """Index, frame id, shift, length, signed, big-endian, float; scale, offset: of a bus's signals."""
        entries = [(i, b) for i, b in enumerate(self._watched) if b.bus == bus]
        places = [
            (
                i,
                b.frame_id,
                b.signal.shift,
                b.signal.length,
                b.signal.signed,
                b.signal.big_endian,
                b.signal.is_float,
            )
            for i, b in entries
        ]
        return np.array(places, np.int64), np.array([(b.signal.scale, b.signal.offset) for _, b in entries])


@compiled
def _scan(ids, times, payloads, places, scales, limits, allowed, largest, beyond, seen):  # type: ignore[no-untyped-def]
    """Update largest values, samples beyond the limit and last times; index of a tripped signal or -1."""
    tripped = -1
    for frame in range(ids.shape[0]):
        for entry in range(places.shape[0]):
            index, frame_id, shift, length, signed, big_endian, is_float = places[entry]
            if ids[frame] != frame_id:
                continue
            word = payloads[frame]
            if big_endian:
                word = swapped(word)
            bits = (word >> np.uint64(shift)) & (~np.uint64(0) >> np.uint64(64 - length))
            if is_float:
                read = single_of(bits) if length == 32 else double_of(bits)
            else:
                raw = np.int64(bits)
                if signed and raw >> (length - 1):
                    raw -= 1 << length
                read = np.float64(raw)
            value = abs(read * scales[entry, 0] + scales[entry, 1])
            if np.isnan(value):  # a device that does not know its value is not known to be within the limit
                value = np.inf
            seen[index] = times[frame]
            largest[index] = max(largest[index], value)
            beyond[index] = beyond[index] + 1 if value > limits[index] else 0
            if beyond[index] > allowed:
                tripped = index
    return tripped
