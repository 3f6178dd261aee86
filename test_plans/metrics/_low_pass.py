"""A low-pass filter that delays nothing: Butterworth of second order, forward and backward.

scipy.signal has it, and takes longer to import than a plan takes to be predicted and judged.
"""

from __future__ import annotations

import math

import numpy as np

from hil.core.runtime.compiled import compiled
from test_plans.conductor import Array

ORDER = 2


def low_passed(values: Array, corner_hz: float, spacing_s: float) -> Array:
    """`values`, shape (n,), every `spacing_s`, without what lies above `corner_hz`.

    Both ends are continued by their point reflection for a period of the corner frequency, so that the
    filter starts and ends at rest (`scipy.signal.sosfiltfilt` with `padtype="odd"`).
    """
    padding = min(len(values) - 1, math.ceil(1 / (corner_hz * spacing_s)))
    head = 2 * values[0] - values[padding:0:-1]
    tail = 2 * values[-1] - values[-2 : -padding - 2 : -1]
    padded = np.concatenate([head, values, tail])
    b, a_1, a_2 = _butterworth(corner_hz * spacing_s)
    _run(padded, b, a_1, a_2)
    _run(padded[::-1], b, a_1, a_2)
    return padded[padding : len(padded) - padding]


def _butterworth(corner: float) -> tuple[float, float, float]:
    """b_0 = b_1/2 = b_2, a_1 and a_2 for a corner in cycles a sample (Tustin's rule, prewarped)."""
    w = math.tan(math.pi * corner)
    whole = 1 + math.sqrt(2) * w + w * w
    return w * w / whole, 2 * (w * w - 1) / whole, (1 - math.sqrt(2) * w + w * w) / whole


@compiled
def _run(x, b, a_1, a_2):  # type: ignore[no-untyped-def]
    """Filter in place, from a state as if the first value had been there for ever."""
    first = (1.0 - b) * x[0]
    second = (b - a_2) * x[0]
    for i in range(x.shape[0]):
        y = b * x[i] + first
        first = 2.0 * b * x[i] - a_1 * y + second
        second = b * x[i] - a_2 * y
        x[i] = y
