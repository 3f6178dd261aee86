"""Smooth functions that laws share."""

from __future__ import annotations

import math

_SURELY_ONE = 20.0


def tanh(u: float) -> float:
    """tanh(u) to 1e-10 of itself: the library's takes longer than all the rest of a step."""
    above, below = tanh_over(u)
    return above / below


def tanh_over(u: float) -> tuple[float, float]:
    """tanh(u) as a quotient that is not yet divided: one division may do for more than it."""
    if abs(u) < 0.5:
        return _fraction(u)
    if abs(u) > _SURELY_ONE:
        return math.copysign(1.0, u), 1.0
    a, b = _fraction(u / 64.0)
    for _ in range(6):  # of twice the argument each
        a, b = 2.0 * a * b, a * a + b * b
    return a, b


def _fraction(u: float) -> tuple[float, float]:
    """A continued fraction, cut off."""
    s = u * u
    return u * (945.0 + s * (105.0 + s)), 945.0 + s * (420.0 + 15.0 * s)
