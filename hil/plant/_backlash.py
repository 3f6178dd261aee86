"""Free play in series with elastic, damped shafts: the exact model of a gap.

The gap's own position, the seat, is a state. In contact it stands at one end of the gap and the shafts carry
k·e + c·de/dt of one sign; once that would pull, contact is lost and the shafts, free, relax with the time
constant c / k until the seat has moved to an end again. A vanishing gap leaves the shaft itself, which a
vanishing dead zone of the twist does not (Nordin, Galic and Gutman, Int. J. Adaptive Control and Signal
Processing 11, 1997).
"""

from __future__ import annotations

import math

from hil.core.compiled import inlined
from hil.plant import _slots as P


@inlined
def gap_torque(stretch, rate, seat, p):  # type: ignore[no-untyped-def]
    """Torque in N m of shafts stretched by `stretch` rad beyond the `seat`; `rate` is that of the twist."""
    torque = p[P.SHAFT_STIFFNESS] * stretch + p[P.SHAFT_DAMPING] * rate
    if seat >= p[P.HALF_GAP]:
        return max(0.0, torque)
    if seat <= -p[P.HALF_GAP]:
        return min(0.0, torque)
    return 0.0


@inlined
def moved_seat(seat, before, after, h, p):  # type: ignore[no-untyped-def]
    """The seat after a step of `h` seconds in which the twist went from `before` to `after` rad."""
    kept = 0.0
    if p[P.SHAFT_DAMPING] > 0.0:
        kept = math.exp(-h * p[P.SHAFT_STIFFNESS] / p[P.SHAFT_DAMPING])
    return min(max(after - kept * (before - seat), -p[P.HALF_GAP]), p[P.HALF_GAP])
