"""What a wire makes of the numbers that cross it: how it rounds them, and when their frames appear."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.core.can.signals import Signal
from hil.core.channels import TIME
from hil.plant.closed_loop import tick as T

Array = npt.NDArray[np.float64]

_COLUMNS = {
    "motor_speed_rad_s": T.MOTOR_SPEED,
    "motor_torque_ref_nm": T.TORQUE_REF,
    "motor_torque_nm": T.TORQUE,
    "driving_torque_ref_nm": T.DRIVING_REF,
    "driving_torque_est_nm": T.DRIVING_EST,
    "wheel_speed_left_rad_s": T.WHEEL_LEFT,
    "shaft_torque_left_nm": T.SHAFT_LEFT,
    "dyno_torque_left_nm": T.LOAD_LEFT,
    "vehicle_speed_m_s": T.VEHICLE_SPEED,
    "wheel_speed_right_rad_s": T.WHEEL_RIGHT,
    "shaft_torque_right_nm": T.SHAFT_RIGHT,
    "dyno_torque_right_nm": T.LOAD_RIGHT,
}
# Channels that a recording computes from both sides: (name, left, right, share of the sum)
_BOTH_SIDES = (
    ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s", 0.5),
    ("shaft_torque_nm", "shaft_torque_left_nm", "shaft_torque_right_nm", 1.0),
    ("dyno_torque_ref_nm", "dyno_torque_left_nm", "dyno_torque_right_nm", 1.0),
)
_EXACT_BITS = 52  # whole numbers up to these a float has


@dataclass(frozen=True)
class Wire:
    """How a bench's frames round.

    Args:
        channels: the signal that shows each measured channel.
        request: torque requests (N m); parameter: values of the RMCU's parameters;
            target_speed: speeds that the drives are reported (rad/s).
        late: samples by which the frame that a recording takes for a channel is not of the sample itself
            (-1: of the one before); channels that are left out are of the sample.
    """

    channels: Mapping[str, Signal]
    request: Signal
    parameter: Signal
    target_speed: Signal
    late: Mapping[str, int] = field(default_factory=dict)

    def channel(self, name: str, rows: Array) -> Array:
        """A measured channel of bench rows, as its frames show it."""
        return rounded(self.channels[name], rows[:, _COLUMNS[name]])

    def recorded(
        self, rows: Array, sample_time_s: float, names: Collection[str] | None = None
    ) -> dict[str, Array]:
        """The channels of a recording that begins with the first of `rows`; those in `names`, or all."""
        samples = np.arange(len(rows))
        channels = {TIME: np.round(samples * sample_time_s, 9)}
        for name in self.channels if names is None else self._needed(names):
            late = self.late.get(name, 0)
            values = self.channel(name, rows)
            channels[name] = values[np.clip(samples + late, 0, len(rows) - 1)] if late else values
        for name, left, right, share in _BOTH_SIDES:
            if left in channels and right in channels:
                channels[name] = share * (channels[left] + channels[right])
        return channels

    def _needed(self, names: Collection[str]) -> list[str]:
        """Measured channels that are wanted, or that wanted ones are computed from."""
        wanted = {*names}
        wanted |= {side for name, *sides, _ in _BOTH_SIDES if name in names for side in sides}
        return [name for name in self.channels if name in wanted]


def rounded(signal: Signal, values: npt.ArrayLike) -> Array:
    """Physical values as they come out of a frame: `Signal.decode` of `Signal.encode`, in less time."""
    if signal.is_float or signal.length > _EXACT_BITS:
        return signal.decode(signal.encode(values))
    counts = np.rint((np.atleast_1d(np.asarray(values, float)) - signal.offset) / signal.scale)
    return np.asarray(np.clip(counts, *signal.counts) * signal.scale + signal.offset)
