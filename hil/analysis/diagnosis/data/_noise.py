"""How noisy each channel is, read from its own spectrum."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._thresholds import CANCELLING, FLOOR_BAND
from hil.analysis.diagnosis.data._trace import Trace
from hil.analysis.power_density import power_density

Array = npt.NDArray[np.float64]


def noise_levels(traces: Sequence[Trace]) -> Array:
    """Standard deviation of each channel's noise per sample, from the spectrum above all modes; shape (3,).

    The median over frequency and over recordings leaves out lines and blows. NaN for a channel that no
    recording has.
    """
    return _pooled(traces, lambda t, c: _level(t.samples[:, c], t.dt))


def cancelling(traces: Sequence[Trace], noise: Array) -> Array:
    """Noise per sample as block means show it, shape (3,): NaN unless it is clearly less than `noise`.

    Errors of neighbouring samples cancel where a speed is the difference of an encoder's positions: its
    noise grows with frequency, and means of some samples know the speed far better than white noise would
    let them.
    """
    shown = _pooled(traces, lambda t, c: _level(t.measured[:, c], t.dt * t.block) * np.sqrt(t.block))
    return np.where(shown < CANCELLING * noise, shown, np.nan)


def rising(traces: Sequence[Trace], means: Array, noise: Array) -> Array:
    """Standard deviation per sample of noise that grows with frequency, like `noise` elsewhere; shape (3,).

    Its spectrum above that of block means counts as it is. Below it, power in proportion to the square of the
    frequency has a third of what it has there: `means`, from `cancelling`, squared.
    """
    risen = _pooled(traces, lambda t, c: _risen(t, c, float(means[c])) if np.isfinite(means[c]) else np.nan)
    return np.where(np.isfinite(risen), risen, noise)


def _risen(trace: Trace, column: int, means: float) -> float:
    f, density = _spectrum(trace.samples[:, column], trace.dt)
    above = f > 0.5 / (trace.dt * trace.block)
    share = float(np.mean(above))
    return float(np.sqrt(share * np.mean(density[above]) * 0.5 / trace.dt + (1.0 - share) * means**2 / 3.0))


def _level(values: Array, step: float) -> float:
    """Standard deviation of a sample of what the top of the spectrum shows; `step` in s."""
    f, density = _spectrum(values, step)
    inside = (f >= FLOOR_BAND[0] / step) & (f <= FLOOR_BAND[1] / step)
    return float(np.sqrt(np.median(density[inside]) * 0.5 / step))


def _spectrum(values: Array, step: float) -> tuple[Array, Array]:
    f, density = power_density(values[:, None], step, min(1024, len(values)), average="median")
    return f, density[:, 0]


def _pooled(traces: Sequence[Trace], level: Callable[[Trace, int], float]) -> Array:
    """Median of each channel's `level` over the recordings that have it, shape (3,); NaN where none has."""
    pooled = np.full(3, np.nan)
    for column in range(3):
        levels = np.array([level(trace, column) for trace in traces if trace.has[column]])
        if np.isfinite(levels).any():
            pooled[column] = float(np.median(levels[np.isfinite(levels)]))
    return pooled


def usable_noise(noise: Array) -> Array:
    """A channel without any noise still needs a weight: a millionth of a unit."""
    return np.where(np.isfinite(noise), np.maximum(noise, 1e-6), np.nan)
