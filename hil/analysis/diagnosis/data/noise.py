"""Noise of channels: by the spectrum above all modes, and as bench files state it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.missing_effects import white_level
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.recording import Recording

_BENCH_FILE, _TABLE = "bench.toml", "noise"


def stated_noise(recordings: Sequence[Recording]) -> dict[str, float]:
    """Standard deviation of a sample by channel, the largest that the recordings' bench files state.

    A recording without its bench file, or with one that is none, states nothing.
    """
    found: dict[str, float] = {}
    for recording in recordings:
        for channel, value in _table(recording).items():
            if not isinstance(value, int | float) or isinstance(value, bool):
                continue
            if channel in OUTPUTS and np.isfinite(value) and value >= 0.0:
                found[channel] = max(found.get(channel, 0.0), float(value))
    return found


def _table(recording: Recording) -> dict[str, object]:
    try:
        bench = parse_toml(recording.attachments.get(_BENCH_FILE, b"").decode(), _BENCH_FILE)
    except (UnicodeDecodeError, BadInputError):
        return {}
    table = bench.get(_TABLE)
    return table if isinstance(table, dict) else {}


Array = npt.NDArray[np.float64]


def noise_levels(traces: Sequence[Trace]) -> Array:
    """Standard deviation of each channel's noise per sample, from the spectrum above all modes; shape (3,).

    The median over frequency and over recordings leaves out lines and blows. NaN for a channel that no
    recording has.
    """
    return _pooled(traces, lambda t, c: white_level(t.samples[:, c]))


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
