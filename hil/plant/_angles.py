"""Angles: integrated from recorded speeds, and as an encoder gives them in place of a speed.

An encoder's reading is a model's output like a speed: of both it is compared what they turn by within a few
milliseconds around each sample. Read so, an angle says all that it says (differences of white noise have a
known colour, by which they are weighed), and what a model gathered long before does not count again.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.channels import OUTPUTS, read_from
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.plant.sensors import mean_around, way_of

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

SPEEDS: Flags = np.zeros(len(OUTPUTS), dtype=bool)
"""Of no output as an angle."""
TURNED_OVER_S = 0.004
"""Within which an angle is read, or two samples: what an axle's bends in a speed leave alone up to 50 Hz."""
_ALIKE = 1e-3  # of the usual distance of levels: nearer ones are one level, written with other digits
_SURE_RAD, _MOSTLY = 0.5 * np.pi, 0.99  # of a wrapped angle's steps so many are at most so large


def by_angle(recording: Recording) -> Flags:
    """Which of `OUTPUTS` a recording has as an angle alone, (3,)."""
    sources = read_from(recording)
    return np.array([sources.get(name, name) != name for name in OUTPUTS], dtype=bool)


def half_window(dt: float) -> int:
    """Samples to either side within which an angle is read."""
    return max(1, round(0.5 * TURNED_OVER_S / dt))


def speed_of(angle: Array, dt: float) -> Array:
    """Mean speed in rad/s around each sample of an angle in rad, (n,); at the ends over what is there."""
    half, last = half_window(dt), len(angle) - 1
    at = np.arange(len(angle))
    before, after = np.maximum(at - half, 0), np.minimum(at + half, last)
    return np.asarray((angle[after] - angle[before]) / (dt * (after - before)))


def angle_at(recording: Recording, angle: str, grid: Array) -> Array:
    """A recorded angle in rad at the times of a grid, straight between its readings.

    One that begins again with every turn goes on instead.

    Raises:
        BadInputError: it begins again with every turn, and turns too far between samples to say which way.
    """
    values = recording[angle]
    if np.ptp(values) <= 2.0 * np.pi and np.any(np.abs(np.diff(values)) > np.pi):
        values = np.unwrap(values)
        if np.quantile(np.abs(np.diff(values)), _MOSTLY) > _SURE_RAD:
            raise BadInputError(
                f"'{angle}' begins again with every turn and turns by more than a quarter of one "
                "between samples: it cannot be known which way",
                where=str(recording.source),
                fix="record faster, or give a position that goes on",
            )
    return np.asarray(np.interp(grid, recording.time_s, values), dtype=float)


def as_read(speeds: Array, of_angle: Flags, dt: float) -> Array:
    """Columns of speeds (n x 3), those read as an angle in place of a speed as `speed_of` reads them."""
    if not of_angle.any() or len(speeds) < 2:
        return speeds
    columns = [
        mean_around(np.ascontiguousarray(one), half_window(dt)) if turns else one
        for one, turns in zip(speeds.T, of_angle.tolist(), strict=True)
    ]
    return np.column_stack(columns)


def angle_of(speed: Array, dt: float, first_rad: float) -> Array:
    """Angle in rad of a speed in rad/s, (n,), from the first sample's on."""
    return np.asarray(first_rad + dt * way_of(np.ascontiguousarray(speed)))


def turned(samples: Array, dt: float, gear_ratio: float, first_wheel_angle_rad: float = 0.0) -> Array:
    """Wheel and rotor angle in rad at every sample (n x 2), by the trapezoidal rule.

    A simulated angle drifts off as long as a model is not right to the last digit, and takes the phase of a
    ripple with it; the measured one does not.

    Args:
        samples: n x 2 or more, motor and wheel speed in rad/s; a column of NaN follows from the other.
    """
    motor, wheel = samples[:, 0], samples[:, 1]
    if not np.isfinite(wheel[0]):
        wheel = motor / gear_ratio
    if not np.isfinite(motor[0]):
        motor = wheel * gear_ratio
    speeds = np.nan_to_num(np.column_stack([wheel, motor]))
    ways = np.cumsum(0.5 * dt * (speeds[1:] + speeds[:-1]), axis=0)
    first = first_wheel_angle_rad * np.array([1.0, gear_ratio])
    return np.asarray(first + np.concatenate([np.zeros((1, 2)), ways]), dtype=float)


def rounding_step(values: Array, *, often: bool = True) -> float:
    """Distance between the readings that a channel takes, in its unit; 0.0 where they are a continuum.

    Readings lie on a grid where there are far fewer levels than samples and nearly all differences of
    neighbouring levels are whole multiples of the smallest usual one.

    Args:
        often: whether each level must be read often; not of an angle that goes on.
    """
    gaps = np.diff(np.unique(values))
    gaps = (
        gaps[gaps > _ALIKE * np.quantile(gaps, 0.9, method="lower")] if len(gaps) else gaps
    )  # digits of a level
    if len(gaps) < 2 or (often and 4 * (len(gaps) + 1) > len(values)):
        return 0.0
    step = float(np.median(gaps[gaps <= 1.5 * np.quantile(gaps, 0.1)]))
    off = np.abs(gaps / step - np.rint(gaps / step))
    return step if np.mean(off < 0.05) > 0.9 else 0.0
