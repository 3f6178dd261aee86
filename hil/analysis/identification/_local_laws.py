"""What channels have to do with each other whatever hangs on the axle: a free wheel, a road or a dyno.

Two laws hold between rotor and wheel and say nothing of what lies behind the wheel (T after the dead time τ):

    e^{-sτ} = J_m s G_m + b G_m + G_s/N                     rotor: torque that does not speed it up goes on
    G_s = (k/s + d) (G_m/N - G_l)                            shafts: they twist by what motor and wheel differ

with G_m, G_l, G_s the responses of motor speed, wheel speed and shaft torque to the torque. Both are linear
in what is unknown. And however the shafts twist, motor and wheel turn by the same angle in the long run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import Experiment, FrequencyResponse
from hil.core.channels import OUTPUTS

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_MOTOR, _WHEEL, _SHAFT = OUTPUTS
_DEAD_TIMES_S = np.arange(0.0, 0.0505, 0.001)
_KNOWN = 0.3  # a response whose deviation is a larger share of it tells nothing
_LEAST_LINES = 12
_LARGEST_RESIDUAL = 0.3  # of what a law explains: beyond, it does not hold in these data
_SIGNIFICANT = 6.0  # standard errors
_TURNED_RAD = 0.25  # rms of the slower one: several times what play and twist are
_FAST_RAD_S = 5.0  # mean speed of the slower one: several times any offset
_RELATED = 0.5  # correlation
_LOW_HZ = 0.3  # below the first anti-resonance, where all that turns turns together
_HELD_SLOPE = 1.5  # of acceleration over frequency: 0 free, 1 against drag, 2 where a dyno holds the wheel
_FREE_SLOPE = 0.5
_SIGN = 0.7  # cosine of 45°: between inertia and drag


@dataclass(frozen=True)
class RotorLaw:
    """Torque ratio and rotor inertia (kg m²) with their signs; None where the data do not tell one."""

    ratio: float | None
    inertia_kg_m2: float | None


def rotor_law(frf: FrequencyResponse) -> RotorLaw:
    """The rotor's law, where motor speed and shaft torque were measured and it holds."""
    nothing = RotorLaw(None, None)
    if _MOTOR not in frf.outputs or _SHAFT not in frf.outputs:
        return nothing
    known = _known(frf, _MOTOR, _SHAFT)
    if np.count_nonzero(known) < _LEAST_LINES:
        return nothing
    s = 2j * np.pi * frf.frequency_hz[known]
    motor, shaft = frf.of(_MOTOR)[known], frf.of(_SHAFT)[known]
    # a resonance is large, and no better known for that
    weight = 1.0 / (1.0 + np.abs(shaft) / np.median(np.abs(shaft)))
    columns = np.stack([s * motor, motor, shaft], axis=1)
    fits = [_least_squares(columns, np.exp(-s * delay), weight) for delay in _DEAD_TIMES_S]
    values, errors, residual = min(fits, key=lambda fit: fit[2])
    if not residual < _LARGEST_RESIDUAL:
        return nothing
    inertia, _, share = (
        float(v) if abs(v) > _SIGNIFICANT * e else None for v, e in zip(values, errors, strict=True)
    )
    return RotorLaw(None if share is None else 1.0 / share, inertia)


def speed_ratio(experiments: Sequence[Experiment], frf: FrequencyResponse) -> float | None:
    """Motor over wheel speed with its sign: by what turned, by the shafts' law; None: untold."""
    if _MOTOR not in frf.outputs or _WHEEL not in frf.outputs:
        return None
    turns, means = [], []
    for experiment in experiments:
        rows = [experiment.outputs[experiment.output_names.index(name)] for name in (_MOTOR, _WHEEL)]
        angles = np.array([_turned(row, experiment.sample_time_s) for row in rows])
        if np.min(np.std(angles, axis=1)) > _TURNED_RAD:
            turns.append(angles)
        mean = np.array([[np.mean(row)] for row in rows])
        if np.min(np.abs(mean)) > _FAST_RAD_S:
            means.append(mean)
    for pairs in (turns, means):
        if pairs:
            motor, wheel = np.concatenate(pairs, axis=1)
            sizes = float(np.linalg.norm(motor)), float(np.linalg.norm(wheel))
            correlation = float(motor @ wheel) / (sizes[0] * sizes[1])
            if abs(correlation) > _RELATED:
                return float(np.sign(correlation)) * sizes[0] / sizes[1]
    shafts = _shafts_ratio(frf)
    return _slow_ratio(frf) if shafts is None else shafts


def _slow_ratio(frf: FrequencyResponse) -> float | None:
    """By slow lines, where neither speed is held."""
    if slow_inertia(frf, _MOTOR) is None or slow_inertia(frf, _WHEEL) is None:
        return None
    low = _known(frf, _MOTOR, _WHEEL) & (frf.frequency_hz <= _LOW_HZ)
    if not low.any():
        return None
    ratio = frf.of(_MOTOR)[low] / frf.of(_WHEEL)[low]
    upright = float(np.mean((ratio / np.abs(ratio)).real))
    return float(np.sign(upright) * np.median(np.abs(ratio))) if abs(upright) > _SIGN else None


def _shafts_ratio(frf: FrequencyResponse) -> float | None:
    if _SHAFT not in frf.outputs:
        return None
    known = _known(frf, *OUTPUTS)
    if np.count_nonzero(known) < _LEAST_LINES:
        return None
    s = 2j * np.pi * frf.frequency_hz[known]
    motor, wheel, shaft = (frf.of(name)[known] for name in OUTPUTS)
    columns = np.stack([motor / s, motor, wheel / s, wheel], axis=1)
    values, errors, residual = _least_squares(columns, shaft, 1.0 / np.abs(shaft))
    sure = np.all(np.abs(values[::2]) > _SIGNIFICANT * errors[::2])
    return float(-values[2] / values[0]) if sure and residual < _LARGEST_RESIDUAL else None


def slow_inertia(frf: FrequencyResponse, name: str) -> tuple[float, float | None] | None:
    """Sign with which a speed follows slow torque, and the inertia (kg m²) seen by it if nothing else acts.

    None where the data do not tell: no slow lines, or a dyno holds the wheel and the shafts act as a spring.
    """
    low = _known(frf, name) & (frf.frequency_hz <= _LOW_HZ)
    frequency = frf.frequency_hz[low]
    if frequency.size < 4 or frequency[-1] < 1.3 * frequency[0]:
        return None
    response = frf.of(name)[low]
    acceleration = 2.0 * np.pi * frequency * np.abs(response)
    slope = float(np.polyfit(np.log(frequency), np.log(acceleration), 1)[0])
    upright = float(np.mean((response / np.abs(response) * np.exp(0.25j * np.pi)).real))
    if slope > _HELD_SLOPE or abs(upright) < _SIGN:
        return None
    alone = 1.0 / float(np.median(acceleration)) if abs(slope) < _FREE_SLOPE else None
    return float(np.sign(upright)), alone


def _known(frf: FrequencyResponse, *names: str) -> npt.NDArray[np.bool_]:
    rows = [frf.deviation_of(name) < _KNOWN * np.abs(frf.of(name)) for name in names]
    return np.asarray(np.all(rows, axis=0))


def _turned(speed: Array, step_s: float) -> Array:
    """Angle without its even turning, rad."""
    angle = np.cumsum(speed) * step_s
    at = np.linspace(-1.0, 1.0, len(angle))
    return np.asarray(angle - np.polynomial.Legendre.fit(at, angle, 1)(at))


def _least_squares(columns: ComplexArray, aim: ComplexArray, weight: Array) -> tuple[Array, Array, float]:
    """Real coefficients of complex columns (lines x n), their standard errors, and the share left over."""
    left = np.concatenate([(columns * weight[:, None]).real, (columns * weight[:, None]).imag])
    right = np.concatenate([(aim * weight).real, (aim * weight).imag])
    scale = np.maximum(np.linalg.norm(left, axis=0), 1e-300)
    inverse = np.linalg.pinv(left / scale)
    values = inverse @ right
    rest = right - left / scale @ values
    variance = float(rest @ rest) / max(len(right) - len(scale), 1)
    errors = np.sqrt(variance * np.sum(inverse**2, axis=1))
    return values / scale, errors / scale, float(np.linalg.norm(rest) / np.linalg.norm(right))
