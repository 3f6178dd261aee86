"""How much of an error noise may account for: what rest, repeats, the spectrum or a data sheet prove.

What is left of an error after all physics is not noise for that reason: where recordings are few, short or
nonlinear, nothing coherent may show although the model is wrong. So noise is bounded from outside the
model: its white part by the spectrum above all modes, slow noise by what a channel does while the axle
rests, by what two recordings of the same request do not have in common, or by what the sensor's maker
states.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import (
    CANCELLING,
    FLOOR_BAND,
    LITTLE_TORQUE,
    REPEATED,
    REST_AFTER_S,
    REST_LEAST_S,
    REST_STILL,
    SLOW_UNPROVEN,
)
from hil.analysis.diagnosis.data.trace import Trace, blocks
from hil.analysis.power_density import power_density
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


def proven_noise(traces: Sequence[Trace], noise: Array, stated: Mapping[str, float] | None = None) -> Array:
    """Largest power that noise may have in block means of each channel, shape (3,).

    In variances of a block mean of white noise at level `noise`: 1 where all noise is white. A channel that
    no recording has gets 1.

    Args:
        noise: standard deviation per sample that errors are weighed by, shape (3,).
        stated: standard deviation of a sample by channel, as the bench file or a data sheet says.
    """
    block = traces[0].block
    white = np.full(3, 1.0 + block * (SLOW_UNPROVEN**2 - 1.0))
    unit = np.where(np.isfinite(noise), noise, 1.0) ** 2 / block
    shown = np.maximum(_at_rest(traces), _between_repeats(traces)) / unit
    known = np.array([(stated or {}).get(channel, 0.0) for channel in OUTPUTS]) ** 2 / unit
    return np.asarray(np.maximum(white, SLOW_UNPROVEN**2 * np.maximum(shown, known)))


def _at_rest(traces: Sequence[Trace]) -> Array:
    """Mean square of each channel's block means while the axle rests, 0 where it never does."""
    sums, counts = np.zeros(3), 0
    for trace in traces:
        for first, last in _rests(trace):
            resting = trace.measured[first:last]
            sums += np.nan_to_num(np.sum((resting - resting.mean(axis=0)) ** 2, axis=0))
            counts += last - first - 1
    return sums / max(counts, 1)


def _rests(trace: Trace) -> list[tuple[int, int]]:
    """Stretches of blocks without torque or motion, and long enough after either to have died away."""
    torque = np.abs(blocks(trace.torque[:, None], trace.block)[:, 0])
    idle = torque <= LITTLE_TORQUE * float(np.max(torque, initial=0.0))
    for column in np.flatnonzero(trace.has[:2]).tolist():
        speed = np.abs(trace.measured[:, column])
        idle &= speed <= REST_STILL * float(np.max(speed))
    if not trace.has[:2].any():
        return []
    period = trace.block * trace.dt
    edges = np.flatnonzero(np.diff(np.concatenate([[0], idle.astype(int), [0]])))
    stretches = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    later = [(first + round(REST_AFTER_S / period), last) for first, last in stretches]
    return [(first, last) for first, last in later if (last - first) * period >= REST_LEAST_S]


def _between_repeats(traces: Sequence[Trace]) -> Array:
    """Mean square of what recordings of one request do not share, a channel each, 0 without repeats."""
    sums, counts = np.zeros(3), 0
    for one, other in combinations(traces, 2):
        if not _same_request(one, other):
            continue
        apart = (one.measured - other.measured) / np.sqrt(2.0)
        sums += np.nan_to_num(np.sum((apart - apart.mean(axis=0)) ** 2, axis=0))
        counts += len(apart) - 1
    return sums / max(counts, 1)


def _same_request(one: Trace, other: Trace) -> bool:
    if len(one.torque) != len(other.torque) or not np.array_equal(one.has, other.has):
        return False
    largest = float(np.max(np.abs(one.torque)))
    return bool(np.max(np.abs(one.torque - other.torque)) <= REPEATED * largest)
