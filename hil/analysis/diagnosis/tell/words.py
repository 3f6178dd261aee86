"""What the data say, in words: where an effect acts, and what an unexplained gap looks like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import CONDITIONS, GapMap
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.orders import order_lines
from hil.analysis.diagnosis.tell.drift import common_frequency, density_at, line_in_words
from hil.analysis.diagnosis.tell.thresholds import (
    BAND_SHARES,
    CHANNEL_SHARE,
    DEPENDS,
    EVERYWHERE,
    LEAST_RECORDINGS,
    ORDER_SHARE,
    SPEEDS_DIFFER,
)
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
    return where_changed(problem.traces, problem.noise, without, with_, before, after)


def where_changed(
    traces: Sequence[Trace],
    noise: Array,
    without: Sequence[Array],
    with_: Sequence[Array],
    before: GapMap,
    after: GapMap,
) -> Where:
    """The same of recordings whose channels have `noise`, a standard deviation of a sample, (3,)."""
    power = np.zeros(3)
    frequency = common_frequency([t.dt for t in traces])
    density = np.zeros(len(frequency))
    for trace, a, b in zip(traces, without, with_, strict=True):
        change = np.where(trace.has, (b - a) / noise, 0.0)
        power += np.sum(change**2, axis=0)
        density += density_at(frequency, change, trace.dt, about_mean=False).sum(axis=1) * len(change)
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


def signature(problem: Problem, fit: Fit, gaps: GapMap) -> str:
    """What remains after `fit`: channel, frequency or order, condition, dependence on torque and speed."""
    column = _worst_column(problem, fit)
    words = [f"the gap is largest in {OUTPUTS[column]}"]
    orders = [
        (o.score, side, o.order) for side in ("wheel", "motor") for o in order_lines(problem, fit, side, 1)
    ]  # type: ignore[arg-type]
    excess = max(fit.cost - problem.rows, 1.0)
    strongest = max(orders, default=(0.0, "", 0.0))
    if strongest[0] > ORDER_SHARE * excess:
        words.append(f"it follows {strongest[1]} speed at order {strongest[2]:.3g}")
    elif line := line_in_words(problem, fit, column):
        words.append(line)
    else:
        low, high = _band(problem, fit, column)
        words.append(f"it lies between {low:.2g} and {high:.2g} Hz")
    by = gaps.by_condition[:, column]
    if np.count_nonzero(np.isfinite(by)) > 1:  # with one condition nothing was compared
        words.append(f"it is strongest at: {CONDITIONS[int(np.nanargmax(by))]}")
    words.append(_dependence(problem, fit, column))
    return "; ".join(w for w in words if w)


def _worst_column(problem: Problem, fit: Fit) -> int:
    """The channel with most power above noise, of those that were recorded."""
    power = np.zeros(3)
    for trace, errors in zip(problem.traces, fit.errors, strict=True):
        power += np.sum(errors.channels**2, axis=0) - np.count_nonzero(trace.judged_blocks) * trace.has
    recorded = np.any([trace.has for trace in problem.traces], axis=0)
    return int(np.argmax(np.where(recorded, power, -np.inf)))


def _band(problem: Problem, fit: Fit, column: int) -> tuple[float, float]:
    """Where, in Hz, most of a channel's error is that is more than its noise, the slowest included."""
    frequency = common_frequency([t.dt * t.block for t in problem.traces])
    over = np.zeros(len(frequency))
    for trace, errors in zip(problem.traces, fit.errors, strict=True):
        period = trace.dt * trace.block
        density = density_at(frequency, errors.channels, period, about_mean=False)[:, column]
        over += len(errors.channels) * np.maximum(density - 2.0 * period, 0.0)  # white noise of variance 1
    share = np.cumsum(over) / max(float(over.sum()), 1e-30)
    low, high = np.interp(BAND_SHARES, share, frequency)
    return float(low), float(high)


def _dependence(problem: Problem, fit: Fit, column: int) -> str:
    """What of torque amplitude and speed the error goes with: only where recordings differ in it."""
    levels, torques, speeds = [], [], []
    for trace, errors in zip(problem.traces, fit.errors, strict=True):
        if not trace.has[column]:
            continue
        levels.append(float(np.std(errors.channels[:, column])))
        torques.append(float(np.std(trace.torque)))
        known = trace.measured[:, 0] if trace.has[0] else trace.measured[:, 1] * problem.gear_ratio
        speeds.append(float(np.mean(np.abs(known))))
    if len(levels) < LEAST_RECORDINGS:
        return ""
    depends, little = [], []
    for name, values in (("torque amplitude", torques), ("speed", speeds)):
        if not np.isfinite(values).all() or max(values) <= SPEEDS_DIFFER * min(values):
            continue  # it was the same in all recordings, or not measured
        r = 0.0
        if np.std(levels) > 0:
            r = float(np.corrcoef(np.log(np.maximum(levels, 1e-9)), np.log(np.maximum(values, 1e-9)))[0, 1])
        if abs(r) > DEPENDS:
            depends.append(f"it {'grows' if r > 0 else 'falls'} with {name}")
        else:
            little.append(name)
    if depends:
        return ", ".join(depends)
    return f"it depends little on {' and '.join(little)}" if little else ""
