"""Dry friction on the rotor, for every kernel: true standstill, whatever law says how large it may be.

While the rotor turns, friction is its level against the motion. At standstill it is whatever holds the
rotor, up to the level there, the break-away torque: nothing creeps below it.
Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083-1138.
"""

from __future__ import annotations

from hil.core.runtime.compiled import compiled


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
