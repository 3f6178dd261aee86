"""Channels that drift, in words: what a fit leaves in a channel that is slow, and that no other shows.

Noise of a sensor that is this slow proves nothing about the axle, and no effect of the registry is like it;
who reads that a gap is open wants to know which instrument to look at.

Spectral lines of what a fit leaves, in words: in which recordings, and whether other speeds move them.

A line at one frequency says nothing of other speeds by itself. What is written here was computed: the lines
of each recording are compared with one another, and those of slow stretches with those of fast ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import DRIFT_S
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.tell.thresholds import (
    DRIFT_SHARE,
    DRIFTS_NOISES,
    LINE,
    LINE_WIDTH,
    NEIGHBOURS,
    SHARED,
    SLOW_BINS,
    SPEED_SPREAD,
    SPEEDS_DIFFER,
    STRETCH,
    WORDS_SEGMENT,
)
from hil.analysis.power_density import power_density
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import multiple

Array = npt.NDArray[np.float64]

_UNITS = ("rad/s", "rad/s", "N m")


def drifts(problem: Problem, simulated: Sequence[Array]) -> list[str]:
    """Which channel drifts, by how much within how long: one sentence a channel, the largest drift each.

    Args:
        simulated: channels of each recording at full rate, n x 3, at the best fit.
    """
    errors = [_errors(t, shown) for t, shown in zip(problem.traces, simulated, strict=True)]
    slow = [_slow(error, trace) for error, trace in zip(errors, problem.traces, strict=True)]
    lines = []
    for column in range(3):
        mine = [i for i, t in enumerate(problem.traces) if t.has[column]]
        if not mine or _is_motion(problem, slow, column):
            continue
        # what white noise would leave: one part in sqrt(block) of a sample's, in every block
        white = float(problem.noise[column]) ** 2 / problem.traces[0].block
        whole = np.concatenate([errors[i][:, column] for i in mine])
        part = np.concatenate([slow[i][:, column] for i in mine])
        above = float(np.mean(whole**2)) - white
        swing, index = max((float(np.ptp(slow[i][:, column])), i) for i in mine)
        if swing < DRIFTS_NOISES * float(problem.noise[column]) or np.mean(part**2) < DRIFT_SHARE * above:
            continue
        trace = problem.traces[index]
        lasts, noises = len(trace.torque) * trace.dt, swing / float(problem.noise[column])
        lines.append(
            f"{OUTPUTS[column]} drifts slowly beside all else: by {swing:.3g} {_UNITS[column]} within the "
            f"{lasts:.3g} s of {trace.name}, {multiple(noises)} its noise"
        )
    return lines


def _errors(trace: Trace, shown: Array) -> Array:
    """Measured minus simulated, means over blocks x 3, 0 where not measured."""
    count = len(trace.measured)
    means = shown[: count * trace.block].reshape(count, trace.block, 3).mean(axis=1)
    return np.where(trace.has, trace.measured - means, 0.0)


def _slow(error: Array, trace: Trace) -> Array:
    """The part of an error that swings no faster than a drift."""
    lasts = len(error) * trace.block * trace.dt
    degree = 2 + round(np.pi * lasts / DRIFT_S)
    basis = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, len(error)), degree))[0]
    return np.asarray(basis @ (basis.T @ error))


def _is_motion(problem: Problem, slow: Sequence[Array], column: int) -> bool:
    """Whether the other speed shows the same: then the axle moves otherwise than simulated."""
    other = 1 - column
    if column > 1 or not all(t.has[column] and t.has[other] for t in problem.traces):
        return False
    scale = problem.gear_ratio if column == 0 else 1.0 / problem.gear_ratio
    mine = np.concatenate([s[:, column] for s in slow])
    apart = mine - scale * np.concatenate([s[:, other] for s in slow])
    return bool(np.mean(apart**2) < SHARED**2 * np.mean(mine**2))


@dataclass(frozen=True)
class _Stretch:
    """Part of a recording: mean rotor speed in rad/s (NaN where none was measured), power density."""

    speed: float
    density: Array


def common_frequency(steps: Sequence[float], segment: int = WORDS_SEGMENT) -> Array:
    """Frequencies in Hz that recordings with these sample times have in common."""
    return np.linspace(0.0, 0.5 / max(steps), segment // 2 + 1)


def density_at(
    frequency: Array, values: Array, step: float, *, about_mean: bool, segment: int = WORDS_SEGMENT
) -> Array:
    """Power density of `values` (n x channels), sampled every `step` seconds, at `frequency`."""
    length = min(segment, len(values))
    own, density = power_density(values, step, length, about_mean=about_mean)
    return np.column_stack([np.interp(frequency, own, column) for column in density.T])


def line_of(density: Array) -> int | None:
    """Index of the strongest line of a density, None where nothing stands out of its neighbours."""
    top = 1 + int(np.argmax(density[1:]))
    return top if top > SLOW_BINS and _stands_out(density, top) else None


def line_in_words(problem: Problem, fit: Fit, column: int) -> str:
    """The strongest line in the errors of a channel and what is known of it, "" where there is none."""
    measured = [i for i, t in enumerate(problem.traces) if t.has[column]]
    frequency = common_frequency([problem.traces[i].dt * problem.traces[i].block for i in measured])
    densities = {i: _density(problem, fit, i, column, frequency) for i in measured}
    top = line_of(np.mean([*densities.values()], axis=0))
    if top is None:
        return ""
    own = {i: line for i, density in densities.items() if (line := line_of(density)) is not None}
    if any(abs(line - top) > LINE_WIDTH for line in own.values()):
        at = [f"at {frequency[line]:.3g} Hz in {problem.traces[i].name}" for i, line in own.items()]
        return f"it is a line {', '.join(at)}"
    words = f"it is a line at {frequency[top]:.3g} Hz"
    if own and len(own) < len(measured):
        return f"{words} in {', '.join(problem.traces[i].name for i in own)} alone"
    at_speeds = _at_speeds(problem, fit, column, float(frequency[top]))
    return f"{words}, {at_speeds}" if at_speeds else words


def speeds_differ(problem: Problem) -> bool | None:
    """Whether a line that follows the speed would have moved; None where no speed was measured."""
    speeds = np.concatenate([_speed(trace, problem.gear_ratio) for trace in problem.traces])
    if not np.isfinite(speeds).any():
        return None
    slow, fast = np.nanpercentile(speeds, SPEED_SPREAD)
    return bool(fast > SPEEDS_DIFFER * slow)


def _density(problem: Problem, fit: Fit, index: int, column: int, frequency: Array) -> Array:
    trace = problem.traces[index]
    errors = fit.errors[index].channels[:, [column]]
    return density_at(frequency, errors, trace.dt * trace.block, about_mean=True)[:, 0]


def _at_speeds(problem: Problem, fit: Fit, column: int, line_hz: float) -> str:
    """Whether a line is there in slow stretches as in fast ones; "" where the data do not show that."""
    differ = speeds_differ(problem)
    if differ is None:
        return ""
    if not differ:
        return "at the one speed of these recordings"
    frequency, stretches = _stretches(problem, fit, column)
    stretches.sort(key=lambda one: one.speed)
    third = len(stretches) // 3
    if not third:
        return ""
    ends = (stretches[:third], stretches[-third:])
    slow, fast = (float(np.mean([one.speed for one in end])) for end in ends)
    if fast <= SPEEDS_DIFFER * slow:
        return ""
    at = int(np.argmin(np.abs(frequency - line_hz)))
    there = [_is_there(np.mean([one.density for one in end], axis=0), at) for end in ends]
    if all(there):
        return f"with the rotor at {slow:.3g} rad/s as at {fast:.3g} rad/s"
    if any(there):
        return f"with the rotor at {slow if there[0] else fast:.3g} rad/s alone"
    return ""


def _stretches(problem: Problem, fit: Fit, column: int) -> tuple[Array, list[_Stretch]]:
    """Frequencies, and stretches of equal length of all recordings in which a speed was measured."""
    measured = [i for i, t in enumerate(problem.traces) if t.has[column]]
    frequency = common_frequency([problem.traces[i].dt * problem.traces[i].block for i in measured], STRETCH)
    found = []
    for index in measured:
        trace, errors = problem.traces[index], fit.errors[index].channels[:, [column]]
        speed = _speed(trace, problem.gear_ratio)
        for first in range(0, len(errors) - STRETCH + 1, STRETCH):
            part, period = slice(first, first + STRETCH), trace.dt * trace.block
            if not np.isfinite(speed[part]).any():
                continue
            density = density_at(frequency, errors[part], period, about_mean=True, segment=STRETCH)
            found.append(_Stretch(float(np.nanmean(speed[part])), density[:, 0]))
    return frequency, found


def _speed(trace: Trace, gear_ratio: float) -> Array:
    """Magnitude of the rotor's speed in rad/s, NaN where neither speed was measured."""
    return np.abs(trace.measured[:, 0] if trace.has[0] else trace.measured[:, 1] * gear_ratio)


def _is_there(density: Array, at: int) -> bool:
    """Whether a line stands at an index or right beside it."""
    first = max(1, at - LINE_WIDTH)
    return _stands_out(density, first + int(np.argmax(density[first : at + LINE_WIDTH + 1])))


def _stands_out(density: Array, top: int) -> bool:
    around = float(np.median(density[max(1, top - NEIGHBOURS) : top + NEIGHBOURS]))
    return bool(density[top] > LINE * around)
