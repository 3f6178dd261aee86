"""Smooth functions that laws share."""

from __future__ import annotations

import math

_SURELY_ONE = 20.0
_MOST = 1e6  # rad


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


def sine(u: float) -> float:
    """sin(u) to 1e-14, and to what rounding leaves of u: the library's takes longer than a linear step."""
    if not abs(u) < _MOST:
        return math.sin(u)
    half_turns = math.floor(u / math.pi + 0.5)
    r = u - half_turns * math.pi
    s = r * r
    # nearest to sin(r) within a quarter of a turn, by Chebyshev's polynomials
    y = 1.604472581650378e-10 - 7.337149471974719e-13 * s
    y = 2.755731433302821e-06 + s * (-2.505175667138226e-08 + s * y)
    y = 0.008333333333185965 + s * (-0.0001984126980340545 + s * y)
    y = r * (0.9999999999999997 + s * (-0.16666666666664498 + s * y))
    return -y if half_turns % 2 else y
