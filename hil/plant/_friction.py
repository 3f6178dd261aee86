"""Dry friction on the rotor, for every kernel: Coulomb's law with a Stribeck peak, and true standstill.

While the rotor turns, friction is `level(speed)` against the motion. At standstill it is whatever holds the
rotor, up to `level(0)`, the break-away torque: nothing creeps below it.
Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083-1138.
"""

from __future__ import annotations

import math

from hil.core.compiled import compiled
from hil.plant import _slots as P

_STRIBECK_WIDTH_RAD_S = 2.0


@compiled
def has_friction(p):  # type: ignore[no-untyped-def]
    """Whether the rotor of a packed model can stick."""
    return p[P.COULOMB] != 0.0 or p[P.STRIBECK] != 0.0


@compiled
def friction_level(speed, p):  # type: ignore[no-untyped-def]
    """Largest friction torque in N m of a packed model at a speed of rotor against housing in rad/s."""
    if p[P.STRIBECK] == 0.0:
        return p[P.COULOMB]
    ratio = speed / _STRIBECK_WIDTH_RAD_S
    return p[P.COULOMB] + p[P.STRIBECK] * math.exp(-ratio * ratio)


@compiled
def friction_torque(direction, holding, level):  # type: ignore[no-untyped-def]
    """Friction in N m against positive motion.

    `direction` has the sign of the speed and is 0 at standstill, where friction is the torque `holding`
    that keeps the rotor where it is, as far as `level` reaches.
    """
    if direction > 0.0:
        return level
    if direction < 0.0:
        return -level
    return min(max(holding, -level), level)


@compiled
def mean_friction(before, after, gain, level):  # type: ignore[no-untyped-def]
    """Friction in N m, averaged over a step at whose end the rotor has the speed that friction leaves it.

    Without friction the speed would go evenly from `before` to `after` (rad/s); each N m held over the step
    takes `gain` off its end. The rotor may turn on, stop and stick, or stop and turn the other way.
    """
    way = 1.0 if before > 0.0 or (before == 0.0 and after > 0.0) else -1.0
    end = way * after - gain * level
    if end >= 0.0:
        return way * level
    if way * (after - before) + gain * level < 0.0:  # too strong a drive to stick
        until = way * before / (way * before - end)
        return way * level * (2.0 * until - 1.0)
    return after / gain
