"""How noisy each channel is, read from its own spectrum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import signal

from hil.analysis.diagnosis.data._thresholds import FLOOR_BAND
from hil.analysis.diagnosis.data._trace import Trace

Array = npt.NDArray[np.float64]


def noise_levels(traces: Sequence[Trace]) -> Array:
    """Standard deviation of each channel's noise per sample, from the spectrum above all modes; shape (3,).

    The median over frequency and over recordings leaves out lines and blows. NaN for a channel that no
    recording has.
    """
    levels = np.full((len(traces), 3), np.nan)
    for row, trace in enumerate(traces):
        rate = 1.0 / trace.dt
        for column in np.flatnonzero(trace.has).tolist():
            length = min(1024, len(trace.samples))
            f, density = signal.welch(trace.samples[:, column], rate, nperseg=length, average="median")
            inside = (f >= FLOOR_BAND[0] * rate) & (f <= FLOOR_BAND[1] * rate)
            levels[row, column] = np.sqrt(np.median(density[inside]) * rate / 2.0)
    pooled = np.full(3, np.nan)
    for column in range(3):
        known = levels[np.isfinite(levels[:, column]), column]
        if known.size:
            pooled[column] = float(np.median(known))
    return pooled


def usable_noise(noise: Array) -> Array:
    """A channel without any noise still needs a weight: a millionth of a unit."""
    return np.where(np.isfinite(noise), np.maximum(noise, 1e-6), np.nan)
