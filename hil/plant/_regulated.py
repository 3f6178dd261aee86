"""Wheels that turn as recorded: a dynamometer that regulates their speed, whatever torque that takes.

A wheel so heavy that nothing else turns it, braked by that mass times the recorded deceleration, turns as it
was recorded. So both integrators, fits and replays take a speed as they take a torque. What of the recorded
speed is noise is left out, octave by octave (N. Wiener, 1949): an inertia would make a large torque of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Polynomial

from hil.core.channels import MOTOR_ANGLE, OUTPUTS, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import slots as P
from hil.plant._angles import Flags, angle_at, rounding_step
from hil.plant._linear import linear_system_of
from hil.plant.slots import HEAVY_KG_M2, is_regulated

Array = npt.NDArray[np.float64]

_TOP = 0.6  # of the band up to half the rate: above it a speed is noise alone
_MEDIAN = 0.4549  # of the power of a bin over its mean: turned over, a bin has one part (chi-square of one)
_QUIET, _NOISES = 1e-3, 3.0  # of the largest speed, standard deviations: slower wheels may stand
_LEAST, _END_S = 20, 0.1  # samples, or seconds, by which an end's bend is read
_CLEAR = 10.0  # times the noise: steps of an encoder fill an octave with some times their mean
_LOWEST_HZ = 0.5  # upper edge of the first octave
_MOTOR, _WHEEL, _ = OUTPUTS


def given_outputs(model: Model) -> Flags:
    """Which of `OUTPUTS` a recording gives a model in place of being compared, (3,)."""
    given = is_regulated(model)
    return np.array([given and model.kind == "rigid", given, False], dtype=bool)


@dataclass(frozen=True)
class Turning:
    """A wheel's slope in rad/s² at every sample, and its speed in rad/s, (n,) each.

    `noise` is the variance of a reading in each octave (upper edges `edges_hz`) that it may be off by; of a
    speed (`order` 1) or of an angle (2).
    """

    slope: Array
    speed: Array
    edges_hz: Array
    noise: Array
    order: int

    def noise_at(self, frequency_hz: Array) -> Array:
        """Variance of a sample of the speed by frequency."""
        of_reading = self.noise[np.searchsorted(self.edges_hz[:-1], frequency_hz)]
        return np.asarray(of_reading * (2.0 * np.pi * frequency_hz) ** (2 * (self.order - 1)))

    def geared(self, ratio: float) -> Turning:
        """The same behind a gear that turns so much slower."""
        return replace(self, slope=self.slope / ratio, speed=self.speed / ratio, noise=self.noise / ratio**2)


def turning_of(readings: Array, dt: float, order: int = 1) -> Turning:
    """What a wheel does whose speed was recorded every `dt` seconds with white noise, (n,).

    Args:
        order: 2 where its angle was.
    """
    last, at = len(readings) - 1, dt * np.arange(len(readings))
    bent = _bent_ends(readings, dt)
    straight = readings - bent(at)
    # freed from its trend and turned over at its end it is periodic, without a bend: little leaks into noise
    rate = (straight[-1] - straight[0]) / last
    whole = np.concatenate([straight, 2.0 * straight[-1] - straight[-2:0:-1]]) - rate * np.arange(2 * last)
    transform = np.fft.rfft(whole)
    frequency: Array = np.fft.rfftfreq(len(whole), dt).astype(np.float64)
    octaves = int(np.ceil(np.log2(0.5 / dt / _LOWEST_HZ)))
    edges = np.append(_LOWEST_HZ * 2.0 ** np.arange(max(octaves, 1)), 0.5 / dt)
    power = np.abs(transform) ** 2
    white = max(
        float(np.median(power[frequency > _TOP * 0.5 / dt])) / _MEDIAN,
        len(whole) * rounding_step(readings, often=order == 1) ** 2 / 12.0,
    )
    band = np.searchsorted(edges[:-1], frequency)
    mean = np.bincount(band, power, len(edges)) / np.maximum(np.bincount(band, minlength=len(edges)), 1)
    share = np.maximum(1.0 - white / np.maximum(mean, 1e-300), 0.0)
    share[mean < _CLEAR * white] = 0.0
    kept = transform * share[band]
    slope = np.fft.irfft((2j * np.pi * frequency) ** order * kept, len(whole))[: last + 1]
    slope += bent.deriv(order)(at) + (rate / dt if order == 1 else 0.0)
    smooth = np.fft.irfft(kept, len(whole))[: last + 1] + rate * np.arange(last + 1) + bent(at)
    seen = readings if order == 1 else np.gradient(smooth, dt)
    moved = np.concatenate([[0.0], np.cumsum(0.5 * dt * (slope[1:] + slope[:-1]))])
    return Turning(slope, np.mean(seen - moved) + moved, edges, share * white / len(whole), order)


def _bent_ends(readings: Array, dt: float) -> Polynomial:
    """What bends as readings do at both ends, and has neither value nor slope there."""
    count, lasts = min(max(_LEAST, round(_END_S / dt)), len(readings) // 4), dt * (len(readings) - 1)
    at = dt * np.arange(count)
    first, last = (Polynomial.fit(at, one[:count], 4).deriv(2)(0.0) for one in (readings, readings[::-1]))
    begins = Polynomial([0.0, 0.0, 0.5]) * Polynomial([1.0, -1.0 / lasts]) ** 3
    ends = begins(Polynomial([lasts, -1.0]))
    return float(first) * begins + float(last) * ends


def stands(model: Model, recording: Recording) -> Flags:
    """Whether the wheels stand, or may, at each time stamp: what holds them then is not known."""
    readings, order = wheel_readings(model, recording)
    dt = recording.sample_time_s
    found = turning_of(readings, dt, order)
    unsure = np.sqrt(np.mean(found.noise_at(np.linspace(0.0, 0.5 / dt, 1000))))
    size = np.abs(found.speed)
    return np.asarray(size <= max(_QUIET * float(np.max(size)), _NOISES * float(unsure)))


def turning_load(model: Model, recording: Recording) -> Array:
    """Torque in N m that has a heavy wheel turn as recorded, at the recording's time stamps (n,).

    Raises:
        BadInputError: neither speed nor angle of the wheels was recorded (nor, of a rigid axle, the motor's).
    """
    time_s = recording.time_s
    grid = np.linspace(time_s[0], time_s[-1], len(time_s))
    readings, order = wheel_readings(model, recording)
    slope = turning_of(np.interp(grid, time_s, readings), float(grid[1] - grid[0]), order).slope
    return -HEAVY_KG_M2 * np.interp(time_s, grid, slope)


def wheel_readings(model: Model, recording: Recording) -> tuple[Array, int]:
    """Speed (1) or angle (2) of the wheels as recorded, (n,); of a rigid axle by its motor's, if need be.

    Raises:
        BadInputError: neither was recorded.
    """
    sides = [(_WHEEL, WHEEL_ANGLE, 1.0)]
    if model.kind == "rigid":
        sides.append((_MOTOR, MOTOR_ANGLE, model.parameters["gear_ratio"]))
    for speed, angle, ratio in sides:
        if speed in recording:
            return recording[speed] / ratio, 1
        if angle in recording:
            return angle_at(recording, angle, recording.time_s) / ratio, 2
    raise BadInputError(
        f"has no channel {_WHEEL}, and the model's wheels turn as that says",
        where=str(recording.source),
        fix="record it, or take load_input out of the model file, which then has to hold the vehicle",
    )


def followed(slots: Array, frequency_hz: Array) -> Array:
    """Gain of `OUTPUTS` to the wheels' speed at frequencies above 0, 3 x frequencies.

    Args:
        slots: a packed model whose wheels turn as recorded.
    """
    at_the_wheel = "extra_tyre_torque_nm" if slots[P.KIND] == P.THREE_INERTIA else "vehicle_load_nm"
    shown = linear_system_of(slots).response(frequency_hz, at_the_wheel)
    return np.asarray(np.abs(shown / shown[1]))
