"""How much of an error noise may account for: what rest, repeats, the spectrum or a data sheet prove.

What is left of an error after all physics is not noise for that reason: where recordings are few, short or
nonlinear, nothing coherent may show although the model is wrong. So noise is bounded from outside the
model: its white part by the spectrum above all modes, slow noise by what a channel does while the axle
rests, by what two recordings of the same request do not have in common, or by what the sensor's maker
states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._thresholds import (
    LITTLE_TORQUE,
    REPEATED,
    REST_AFTER_S,
    REST_LEAST_S,
    REST_STILL,
    SLOW_UNPROVEN,
)
from hil.analysis.diagnosis.data._trace import Trace, blocks
from hil.core.channels import OUTPUTS

Array = npt.NDArray[np.float64]


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
    told = np.array([(stated or {}).get(channel, 0.0) for channel in OUTPUTS]) ** 2 / unit
    return np.asarray(np.maximum(white, SLOW_UNPROVEN**2 * np.maximum(shown, told)))


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
