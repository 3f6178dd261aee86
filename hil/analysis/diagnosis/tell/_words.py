"""What the data say, in words: where an effect acts, and what an unexplained gap looks like."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._gap import CONDITIONS, GapMap
from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._orders import order_lines
from hil.analysis.diagnosis.tell._thresholds import (
    BAND_SHARES,
    CHANNEL_SHARE,
    DEPENDS,
    EVERYWHERE,
    LEAST_RECORDINGS,
    LINE,
    ORDER_SHARE,
    SLOW_BINS,
    SPEED_SPREAD,
    SPEEDS_DIFFER,
    WORDS_SEGMENT,
)
from hil.analysis.power_density import power_density
from hil.core.channels import OUTPUTS

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Where:
    """Channels, frequency band and operating condition in which something acts."""

    channels: tuple[str, ...]
    band_hz: tuple[float, float]
    condition: str


def where(problem: Problem, without: list[Array], with_: list[Array], before: GapMap, after: GapMap) -> Where:
    """Where the simulation without an effect and with it (n x 3 each recording) differ most."""
    power = np.zeros(3)
    frequency = _common_frequency([t.dt for t in problem.traces])
    density = np.zeros(len(frequency))
    for trace, a, b in zip(problem.traces, without, with_, strict=True):
        change = np.where(trace.has, (b - a) / problem.noise, 0.0)
        power += np.sum(change**2, axis=0)
        density += _density(change, trace.dt, frequency, about_mean=False).sum(axis=1) * len(change)
    ranked = np.argsort(-power)
    channels = tuple(OUTPUTS[i] for i in ranked if power[i] > CHANNEL_SHARE * power[ranked[0]])
    share = np.cumsum(density) / max(float(density.sum()), 1e-30)
    low, high = np.interp(BAND_SHARES, share, frequency)
    fall = np.nan_to_num(before.by_condition**2 - after.by_condition**2)[:, ranked[0]]
    condition = CONDITIONS[int(np.argmax(fall))]
    spread = (
        "at all operating conditions"
        if fall.max() < EVERYWHERE * max(float(np.median(fall)), 1e-12)
        else condition
    )
    return Where(channels, (round(float(low), 2), round(float(high), 2)), spread)


def _common_frequency(steps: list[float]) -> Array:
    """Frequencies in Hz that recordings with these sample times have in common."""
    return np.linspace(0.0, 0.5 / max(steps), WORDS_SEGMENT // 2 + 1)


def _density(values: Array, step: float, frequency: Array, *, about_mean: bool) -> Array:
    """Power density of `values` (n x 3), sampled every `step` seconds, at `frequency`."""
    length = min(WORDS_SEGMENT, len(values))
    own, density = power_density(values, step, length, about_mean=about_mean)
    return np.column_stack([np.interp(frequency, own, column) for column in density.T])


def signature(problem: Problem, fit: Fit, gaps: GapMap) -> str:
    """What remains after `fit`: channel, frequency or order, condition, dependence on torque and speed."""
    power = np.zeros(3)
    frequency = _common_frequency([t.dt * t.block for t in problem.traces])
    densities = []
    for trace, errors in zip(problem.traces, fit.errors, strict=True):
        e = errors.channels
        power += np.sum(e**2, axis=0) - np.count_nonzero(trace.judged_blocks) * trace.has
        densities.append(_density(e, trace.dt * trace.block, frequency, about_mean=True))
    column = int(np.argmax(power))
    density = np.mean([d[:, column] for d in densities], axis=0)
    top = 1 + int(np.argmax(density[1:]))
    around = float(np.median(density[max(1, top - 20) : top + 20]))
    words = [f"the gap is largest in {OUTPUTS[column]}"]
    line = top > SLOW_BINS and density[top] > LINE * around
    orders = [
        (o.score, side, o.order) for side in ("wheel", "motor") for o in order_lines(problem, fit, side, 1)
    ]  # type: ignore[arg-type]
    excess = max(fit.cost - problem.rows, 1.0)
    strongest = max(orders, default=(0.0, "", 0.0))
    if strongest[0] > ORDER_SHARE * excess:
        words.append(f"it follows {strongest[1]} speed at order {strongest[2]:.3g}")
    elif line:
        at = "at whatever speed" if _speeds_differ(problem) else "at the one speed of these recordings"
        words.append(f"it is a line at {frequency[top]:.3g} Hz, {at}")
    else:
        low, high = _band(problem, fit, column, frequency)
        words.append(f"it lies between {low:.2g} and {high:.2g} Hz")
    by = np.nan_to_num(gaps.by_condition[:, column])
    words.append(f"it is strongest at: {CONDITIONS[int(np.argmax(by))]}")
    words.append(_dependence(problem, fit, column))
    return "; ".join(w for w in words if w)


def _band(problem: Problem, fit: Fit, column: int, frequency: Array) -> tuple[float, float]:
    """Where, in Hz, most of a channel's error is that is more than its noise, the slowest included."""
    over = np.zeros(len(frequency))
    for trace, errors in zip(problem.traces, fit.errors, strict=True):
        period = trace.dt * trace.block
        density = _density(errors.channels, period, frequency, about_mean=False)[:, column]
        over += len(errors.channels) * np.maximum(density - 2.0 * period, 0.0)  # white noise of variance 1
    share = np.cumsum(over) / max(float(over.sum()), 1e-30)
    low, high = np.interp(BAND_SHARES, share, frequency)
    return float(low), float(high)


def _speeds_differ(problem: Problem) -> bool:
    """Whether a line that follows the speed would have moved."""
    speeds = np.concatenate(
        [
            np.abs(t.measured[:, 0] if t.has[0] else t.measured[:, 1] * problem.gear_ratio)
            for t in problem.traces
        ]
    )
    slow, fast = np.nanpercentile(speeds, SPEED_SPREAD) if np.isfinite(speeds).any() else (0.0, 0.0)
    return bool(fast > SPEEDS_DIFFER * slow)


def _dependence(problem: Problem, fit: Fit, column: int) -> str:
    levels, torques, speeds = [], [], []
    for trace, errors in zip(problem.traces, fit.errors, strict=True):
        if not trace.has[column]:
            continue
        levels.append(float(np.std(errors.channels[:, column])))
        torques.append(float(np.std(trace.torque)))
        known = trace.measured[:, 0] if trace.has[0] else trace.measured[:, 1]
        speeds.append(float(np.mean(np.abs(known))))
    if len(levels) < LEAST_RECORDINGS:
        return ""
    names = []
    for name, values in (("torque amplitude", torques), ("speed", speeds)):
        if np.std(values) > 0 and np.std(levels) > 0:
            r = float(np.corrcoef(np.log(np.maximum(levels, 1e-9)), np.log(np.maximum(values, 1e-9)))[0, 1])
            if abs(r) > DEPENDS:
                names.append(f"it {'grows' if r > 0 else 'falls'} with {name}")
    return ", ".join(names) or "it depends little on torque amplitude and speed"
