"""The experiments of a case: 7 recordings of 196 s together, and others that are held out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

SAMPLE_S = 0.001
_LOWEST_HZ, _HIGHEST_HZ = 0.05, 30.0


@dataclass(frozen=True)
class MotorLoop:
    """PI and phase lead on the motor speed: N m per rad/s, N m per rad, s, ratio; no lead at 0 s."""

    proportional: float
    integral: float
    lead_s: float
    lead_ratio: float
    largest_nm: float


@dataclass(frozen=True)
class Experiment:
    """A torque request over time, open loop, or the test signal beside a speed controller."""

    name: str
    torque_nm: Array
    target_rad_s: Array
    wheel_speed_rad_s: float = 0.0
    closed_loop: bool = False
    #: on the motor speed; None with `closed_loop`: on the wheel speed
    motor_loop: MotorLoop | None = None
    #: torque of the dynos in N m, positive against forward motion; None: none, and no channel of it
    load_nm: Array | None = None

    @property
    def duration_s(self) -> float:
        return len(self.torque_nm) * SAMPLE_S


def _experiment(name: str, torque_nm: Array, wheel_speed: float = 0.0) -> Experiment:
    return Experiment(name, torque_nm, np.full(len(torque_nm), wheel_speed), wheel_speed)


def _time(duration_s: float) -> Array:
    return np.arange(round(duration_s / SAMPLE_S), dtype=np.float64) * SAMPLE_S


def _faded(signal: Array, fade_s: float = 0.25) -> Array:
    """Start and end at rest: the plant's past before a recording is then known to be torque-free."""
    samples = round(fade_s / SAMPLE_S)
    ramp = 0.5 - 0.5 * np.cos(np.pi * np.arange(samples) / samples)
    shaped = signal.copy()
    shaped[:samples] *= ramp
    shaped[-samples:] *= ramp[::-1]
    return shaped


def chirp(amplitude_nm: float, bias_nm: float, duration_s: float) -> Array:
    """Logarithmic sweep 0.05 to 30 Hz; a cosine, so that the speed swings about its start."""
    time_s = _time(duration_s)
    lowest = max(_LOWEST_HZ, 1.0 / duration_s)
    rate = np.log(_HIGHEST_HZ / lowest) / duration_s
    phase = 2.0 * np.pi * lowest * np.expm1(rate * time_s) / rate
    return _faded(bias_nm + amplitude_nm * np.cos(phase))


def steps(rng: np.random.Generator, largest_nm: float, duration_s: float) -> Array:
    """Levels of random size held for 0.8 to 1.6 s, up and down, mostly with reversals."""
    torque = np.zeros(len(_time(duration_s)))
    at, sign = 0.4, 1.0
    while at < duration_s - 0.8:
        end = at + rng.uniform(0.8, 1.6)
        level = sign * largest_nm * rng.uniform(0.25, 1.0)
        torque[round(at / SAMPLE_S) : round(end / SAMPLE_S)] = level
        sign = -sign if rng.uniform() < 0.75 else sign
        at = end
    torque[-300:] = 0.0
    return np.asarray(torque - np.mean(torque) * (torque != 0.0))


def multisine(rng: np.random.Generator, rms_nm: float, duration_s: float) -> Array:
    """Random-phase multisine, 0.1 to 30 Hz, lines evenly spread over the logarithm of frequency."""
    time_s = _time(duration_s)
    lines = np.unique(np.round(np.geomspace(0.1, _HIGHEST_HZ, 80) * duration_s)) / duration_s
    phases = rng.uniform(0.0, 2.0 * np.pi, len(lines))
    torque = np.zeros_like(time_s)
    for frequency, phase in zip(lines, phases, strict=True):
        torque += np.cos(2.0 * np.pi * frequency * time_s + phase)
    return _faded(torque * rms_nm / np.std(torque))


def coast_down(rng: np.random.Generator, pulse_nm: float, duration_s: float) -> Array:
    """No torque from speed, then short pulses against the motion."""
    torque = np.zeros(len(_time(duration_s)))
    for start in np.arange(0.55, 0.95, 0.1) * duration_s:
        first = round((start + rng.uniform(0.0, 0.3)) / SAMPLE_S)
        torque[first : first + round(0.8 / SAMPLE_S)] = -pulse_nm * rng.uniform(0.5, 1.0)
    return torque


def low_speed_reversals(rng: np.random.Generator, amplitude_nm: float, duration_s: float) -> Array:
    """Slow triangle through zero torque and speed, with a little faster sine on it."""
    time_s = _time(duration_s)
    turn_hz = rng.uniform(0.35, 0.5)
    triangle = 2.0 / np.pi * np.arcsin(np.cos(2.0 * np.pi * turn_hz * time_s))
    return _faded(amplitude_nm * (triangle + 0.15 * np.cos(2.0 * np.pi * rng.uniform(2.0, 4.0) * time_s)))


def main_set(rng: np.random.Generator, scale: float, length: float = 1.0) -> list[Experiment]:
    """The 7 recordings, 196 s at `length` 1; `scale` multiplies all torques."""
    return [
        _experiment("chirp_small", scale * chirp(rng.uniform(8.0, 12.0), 0.0, length * 40.0)),
        _experiment("chirp_large", scale * chirp(rng.uniform(30.0, 42.0), 0.0, length * 40.0)),
        _experiment(
            "chirp_biased",
            scale * chirp(rng.uniform(5.0, 7.0), rng.uniform(24.0, 28.0), length * 30.0),
            rng.uniform(2.0, 6.0),
        ),
        _experiment("steps", scale * steps(rng, rng.uniform(32.0, 45.0), length * 20.0)),
        _experiment(
            "multisine", scale * multisine(rng, rng.uniform(9.0, 14.0), length * 24.0), rng.uniform(-2.0, 4.0)
        ),
        _experiment("coast_down", scale * coast_down(rng, 12.0, length * 26.0), rng.uniform(18.0, 30.0)),
        _experiment("reversals", scale * low_speed_reversals(rng, rng.uniform(9.0, 14.0), length * 16.0)),
    ]


def holdout_set(rng: np.random.Generator, scale: float, length: float = 1.0) -> list[Experiment]:
    """Other seeds, amplitudes and speeds, 56 s at `length` 1."""
    return [
        _experiment(
            "holdout_chirp",
            scale * chirp(rng.uniform(18.0, 24.0), 0.0, length * 20.0),
            rng.uniform(-1.0, 1.0),
        ),
        _experiment(
            "holdout_multisine",
            scale * multisine(rng, rng.uniform(12.0, 18.0), length * 20.0),
            rng.uniform(4.0, 12.0),
        ),
        _experiment("holdout_steps", scale * steps(rng, rng.uniform(25.0, 38.0), length * 16.0)),
    ]


def in_closed_loop(experiment: Experiment, rng: np.random.Generator) -> Experiment:
    """The same test signal beside a speed controller that holds, or steps, the wheel speed."""
    target = experiment.target_rad_s.copy()
    if experiment.name.endswith("steps"):
        middle = len(target) // 2
        target[middle // 2 : middle] += rng.uniform(0.5, 2.0)
        target[middle:] -= rng.uniform(0.5, 2.0)
    return replace(experiment, target_rad_s=target, closed_loop=True)
