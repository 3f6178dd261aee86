"""What is stated of an effect and of a gap that stays: whether it is worth a name, and where it acts.

What is smaller than a bench's instruments are good to is a correction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import CONDITIONS, GapMap
from hil.analysis.diagnosis.thresholds import (
    BAND_SHARES,
    CHANNEL_SHARE,
    EVERYWHERE,
    LINE_WIDTH,
    TOLERANCES,
    WORDS_SEGMENT,
)
from hil.analysis.missing_effects import TOLERANCE, Series, block_means
from hil.analysis.power_density import power_density
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]


def worth_naming(use: EffectUse, traces: Sequence[Series], least: Mapping[str, float], base: Model) -> bool:
    """Whether an effect is at least as large as the smallest size worth a name.

    An extra dead time adds to the model's own, and is no finding within what that may be off by.

    Args:
        least: sizes that a user set, by effect, in the unit of the effect's first number.
    """
    effect = EFFECTS[use.id]
    known = effect.completed(use.values)
    size = max(abs(float(known[name]) - effect.off) for name in effect.acting())
    if use.id in least:
        return size >= least[use.id]
    if use.id == "dead_time":
        own = base.dead_time_s * base.tolerance.get("torque_delay", TOLERANCE)
        if size < TOLERANCES * own:
            return False
    if effect.least is None:
        return True
    unit = 1.0
    if effect.least.of == "samples":
        unit = traces[0].dt
    elif effect.least.of == "largest torque":
        unit = max(float(np.max(np.abs(t.torque))) for t in traces)
    elif effect.least.of == "rms reading":
        column = OUTPUTS.index(str(use.values["channel"]))
        readings = np.concatenate([t.samples[:, column] for t in traces if t.has[column]])
        unit = float(np.sqrt(np.mean(readings**2)))
    return size >= effect.least.amount * unit


def clean(use: EffectUse) -> EffectUse:
    """Phases within ±π; optional values that were not fitted left out."""
    values = dict(use.values)
    if "phase_rad" in values:
        values["phase_rad"] = float((float(values["phase_rad"]) + np.pi) % (2 * np.pi) - np.pi)
    for parameter in EFFECTS[use.id].parameters:
        if parameter.optional and values.get(parameter.name) == parameter.default:
            del values[parameter.name]
    return EffectUse(use.id, values)


@dataclass(frozen=True)
class Where:
    """Channels, frequency band and operating condition in which something acts."""

    channels: tuple[str, ...]
    band_hz: tuple[float, float]
    condition: str


def where_changed(
    traces: Sequence[Series],
    noise: Array,
    without: Sequence[Array],
    with_: Sequence[Array],
    before: GapMap,
    after: GapMap,
) -> Where:
    """Where the simulation without an effect and with it (n x 3 each recording) differ most.

    Args:
        noise: standard deviation of a sample of each channel, (3,).
    """
    power = np.zeros(3)
    frequency = _common_frequency([t.dt for t in traces])
    density = np.zeros(len(frequency))
    for trace, a, b in zip(traces, without, with_, strict=True):
        change = np.where(trace.has, (b - a) / noise, 0.0)
        power += np.sum(change**2, axis=0)
        density += _density_at(frequency, change, trace.dt).sum(axis=1) * len(change)
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


def band_of_gap(traces: Sequence[Series], noise: Array, simulated: Sequence[Array], column: int) -> str:
    """The line, or the band in Hz, that holds most of what a channel's error is above its noise.

    Args:
        noise: standard deviation of a sample of each channel, (3,).
        simulated: channels of each recording at full rate, n x 3.
    """
    frequency = _common_frequency([t.dt * t.block for t in traces])
    over = np.zeros(len(frequency))
    for trace, values in zip(traces, simulated, strict=True):
        if trace.has[column]:
            period = trace.dt * trace.block
            error = (trace.measured - block_means(values, trace.block))[:, [column]]
            density = _density_at(frequency, error / noise[column], period)[:, 0]
            over += len(error) * np.maximum(density - 2.0 * trace.dt, 0.0)  # white noise of variance 1
    share = np.cumsum(over) / max(float(over.sum()), 1e-30)
    low, high = np.interp(BAND_SHARES, share, frequency)
    if high - low <= LINE_WIDTH * frequency[1]:
        line = float(frequency[int(np.argmax(over))])
        return f"it is a line at {line:.3g} Hz" if line else f"it is slower than {frequency[1]:.2g} Hz"
    return f"it lies between {low:.2g} and {high:.2g} Hz"


def _common_frequency(steps: Sequence[float]) -> Array:
    """Frequencies in Hz that recordings with these sample times have in common."""
    return np.linspace(0.0, 0.5 / max(steps), WORDS_SEGMENT // 2 + 1)


def _density_at(frequency: Array, values: Array, step: float) -> Array:
    """Power density of `values` (n x channels), sampled every `step` seconds, at `frequency`."""
    length = min(WORDS_SEGMENT, len(values))
    own, density = power_density(values, step, length, about_mean=False)
    return np.column_stack([np.interp(frequency, own, column) for column in density.T])
