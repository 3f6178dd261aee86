"""Spectral lines of what a fit leaves, in words: in which recordings, and whether other speeds move them.

A line at one frequency says nothing of other speeds by itself. What is written here was computed: the lines
of each recording are compared with one another, and those of slow stretches with those of fast ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._trace import Trace
from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.tell._thresholds import (
    LINE,
    LINE_WIDTH,
    NEIGHBOURS,
    SLOW_BINS,
    SPEED_SPREAD,
    SPEEDS_DIFFER,
    STRETCH,
    WORDS_SEGMENT,
)
from hil.analysis.power_density import power_density

Array = npt.NDArray[np.float64]


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
