"""The bench's limits, watched on every sample of every frame, below any plan."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from drivers import Binding
from hil.core.errors import BenchError
from hil.core.frames import FrameBlock
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
        self._watched = [(b, largest[b.channel]) for b in bindings if b.channel in largest]
        self._allowed = max(1, round(limits.persistence_s / sample_time_s))
        self._beyond = dict.fromkeys((b.channel for b, _ in self._watched), 0)
        self._seen_s: dict[tuple[str, int], float] = {}
        self._latest_s = 0.0
        self.active = False
        self.largest: dict[str, float] = dict.fromkeys(self._beyond, 0.0)

    def take(self, bus: str, block: FrameBlock) -> None:
        """Look at the frames of one bus.

        Raises:
            BenchError: a limit tripped, or frames stopped coming.
        """
        self._latest_s = max(self._latest_s, float(block["time_s"][-1]))
        ids = block["id"]
        payloads: dict[int, npt.NDArray[np.uint64]] = {}
        for binding, limit in self._watched:
            if binding.bus != bus:
                continue
            if binding.frame_id not in payloads:
                payloads[binding.frame_id] = block["data"][ids == binding.frame_id]
                if len(payloads[binding.frame_id]):
                    self._seen_s[(bus, binding.frame_id)] = self._latest_s
            if len(payloads[binding.frame_id]):
                self._check(binding, limit, payloads[binding.frame_id])
        if self.active:
            self._check_silence()

    def _check(self, binding: Binding, limit: float, payloads: npt.NDArray[np.uint64]) -> None:
        magnitude = np.abs(binding.signal.decode(payloads))
        largest = float(magnitude.max())
        if largest > self.largest[binding.channel]:
            self.largest[binding.channel] = largest
        if largest <= limit:
            self._beyond[binding.channel] = 0
            return
        for beyond in magnitude > limit:
            self._beyond[binding.channel] = self._beyond[binding.channel] + 1 if beyond else 0
            if self.active and self._beyond[binding.channel] > self._allowed:
                unit = binding.signal.unit
                raise BenchError(
                    f"limit tripped: {binding.channel} reached {largest:.4g} {unit}, the limit is {limit:g} {unit}",
                    where="bench limits",
                    fix="lower the plan's torque or speed; the limit is in the bench file",
                )

    def _check_silence(self) -> None:
        for (bus, frame_id), seen_s in self._seen_s.items():
            if self._latest_s - seen_s > _SILENCE_S:
                raise BenchError(
                    f"frame 0x{frame_id:03X} has stopped coming", where=f"bus '{bus}'", fix="is the device powered?"
                )
