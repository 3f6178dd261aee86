"""Smooth functions that laws share."""

from __future__ import annotations

import math


def tanh(u: float) -> float:
    """tanh(u) to 1e-10 of itself: the library's takes longer than all the rest of a step."""
    if abs(u) < 0.5:  # continued fraction
        s = u * u
        return u * (945.0 + s * (105.0 + s)) / (945.0 + s * (420.0 + 15.0 * s))
    return math.copysign(1.0, u) if abs(u) > 20.0 else math.tanh(u)
