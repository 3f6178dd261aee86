"""Wheels that turn as recorded: a dynamometer that regulates their speed, whatever torque that takes.

A wheel so heavy that nothing else turns it, braked by that mass times the recorded deceleration, turns as it
was recorded. So both integrators, fits and replays take a speed as they take a torque. What of the recorded
speed is noise is left out, octave by octave (N. Wiener, 1949): an inertia would make a large torque of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import MOTOR_ANGLE, OUTPUTS, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import slots as P
from hil.plant._angles import Flags, angle_at, speed_of
from hil.plant._linear import linear_system_of
from hil.plant.slots import HEAVY_KG_M2, is_regulated

Array = npt.NDArray[np.float64]

_TOP = 0.6  # of the band up to half the rate: above it a speed is noise alone
_MEDIAN = 0.4549  # of the power of a bin over its mean: turned over, a bin has one part (chi-square of one)
_SEEN = 0.5  # of an octave's power is no noise: the fastest such one says how soon a speed may bend
_LEAST = 20  # samples of an end
_LOWEST_HZ = 0.5  # upper edge of the first octave
_MOTOR, _WHEEL, _ = OUTPUTS


def given_outputs(model: Model) -> Flags:
    """Which of `OUTPUTS` a recording gives a model in place of being compared, (3,)."""
    given = is_regulated(model)
    return np.array([given and model.kind == "rigid", given, False], dtype=bool)


@dataclass(frozen=True)
class Turning:
    """A wheel's slope in rad/s² at every sample (n,), and its speed there in rad/s in the first place.

    `noise` is the variance of a sample in each octave (upper edges `edges_hz`) that its speed may be off by.
    """

    slope: Array
    first: float
    edges_hz: Array
    noise: Array

    def noise_at(self, frequency_hz: Array) -> Array:
        """Variance of a sample by frequency."""
        return np.asarray(self.noise[np.searchsorted(self.edges_hz[:-1], frequency_hz)])


def turning_of(speed: Array, dt: float) -> Turning:
    """What a wheel does whose speed was recorded every `dt` seconds with white noise, (n,)."""
    last = len(speed) - 1
    # turned over at its end and freed from its trend it is periodic, value and slope: little leaks into noise
    rate = (speed[-1] - speed[0]) / last
    whole = np.concatenate([speed, 2.0 * speed[-1] - speed[-2:0:-1]]) - rate * np.arange(2 * last)
    transform = np.fft.rfft(whole)
    frequency: Array = np.fft.rfftfreq(len(whole), dt).astype(np.float64)
    octaves = int(np.ceil(np.log2(0.5 / dt / _LOWEST_HZ)))
    edges = np.append(_LOWEST_HZ * 2.0 ** np.arange(max(octaves, 1)), 0.5 / dt)
    power = np.abs(transform) ** 2
    white = float(np.median(power[frequency > _TOP * 0.5 / dt])) / _MEDIAN
    band = np.searchsorted(edges[:-1], frequency)
    mean = np.bincount(band, power, len(edges)) / np.maximum(np.bincount(band, minlength=len(edges)), 1)
    share = np.maximum(1.0 - white / np.maximum(mean, 1e-300), 0.0)
    kept = transform * share[band]
    slope = np.fft.irfft(2j * np.pi * frequency * kept, len(whole))[: last + 1] + rate / dt
    smooth = np.fft.irfft(kept, len(whole))[: last + 1] + rate * np.arange(last + 1)
    fastest = float(edges[np.max(np.flatnonzero(share > _SEEN), initial=0)])
    slope += _mended_ends(smooth, speed, dt, min(max(_LEAST, round(0.5 / (fastest * dt))), len(speed) // 4))
    moved = np.concatenate([[0.0], np.cumsum(0.5 * dt * (slope[1:] + slope[:-1]))])
    return Turning(slope, float(np.mean(speed - moved)), edges, share * white / len(whole))


def _mended_ends(smooth: Array, speed: Array, dt: float, count: int) -> Array:
    """What a cubic through so many readings at either end adds there to the slope of a smoothed speed.

    Turned over, a speed bends at its ends.
    """
    found, fades = np.zeros(len(speed)), np.linspace(1.0, 0.0, count) ** 2
    for end, share in ((slice(count), fades), (slice(-count, None), fades[::-1])):
        at = np.arange(count) * dt
        cubic = np.polynomial.Polynomial.fit(at, speed[end], 3)
        found[end] = np.gradient(share * (cubic(at) - smooth[end]), dt)
    return found


def turning_load(model: Model, recording: Recording) -> Array:
    """Torque in N m that has a heavy wheel turn as recorded, at the recording's time stamps (n,).

    Raises:
        BadInputError: neither speed nor angle of the wheels was recorded (nor, of a rigid axle, the motor's).
    """
    time_s = recording.time_s
    grid = np.linspace(time_s[0], time_s[-1], len(time_s))
    speed = np.interp(grid, time_s, _wheel_speed(model, recording))
    slope = turning_of(speed, float(grid[1] - grid[0])).slope
    return -HEAVY_KG_M2 * np.interp(time_s, grid, slope)


def _wheel_speed(model: Model, recording: Recording) -> Array:
    sides = [(_WHEEL, WHEEL_ANGLE, 1.0)]
    if model.kind == "rigid":
        sides.append((_MOTOR, MOTOR_ANGLE, model.parameters["gear_ratio"]))
    for speed, angle, ratio in sides:
        if speed in recording:
            return recording[speed] / ratio
        if angle in recording:
            turned = angle_at(recording, angle, recording.time_s)
            return speed_of(turned, recording.sample_time_s) / ratio
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
