"""A state as the laws of effects see it, and which of them do anything."""

from __future__ import annotations

from typing import NamedTuple

from hil.core.chain import Chain
from hil.core.effects import Motion
from hil.core.runtime.compiled import inlined
from hil.plant import _laws as L
from hil.plant import slots as P
from hil.plant import states as X


class Acting(NamedTuple):
    """Where any effect does anything: asked once, before a loop."""

    shaft: bool
    loss: bool
    load: bool
    tyre: bool
    dry: bool
    memory: bool


@inlined
def acting_of(p):  # type: ignore[no-untyped-def]
    """Where any effect of a packed model does anything."""
    return Acting(
        L.moves_shaft(p), L.slows_rotor(p), L.loads(p), L.moves_tyre(p), L.may_stick(p), L.remembers(p)
    )


@inlined
def chain_of(p):  # type: ignore[no-untyped-def]
    """The linear numbers of a packed model by their names."""
    return Chain(
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15]
    )


@inlined
def turning(speed):  # type: ignore[no-untyped-def]
    """What a law of dry friction is reported: the rotor turns against the housing, all else is at rest."""
    return Motion(speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@inlined
def relative_speed(x):  # type: ignore[no-untyped-def]
    """Rotor against housing in rad/s: what the motor's sensor sees and what friction acts on."""
    return x[X.ROTOR_SPEED] - x[X.HOUSING_SPEED]


@inlined
def motion_of(x, chain, memories, wheel_angle, rotor_angle, p):  # type: ignore[no-untyped-def]
    """What laws see of a state."""
    wheel = x[X.WHEEL_SPEED]
    rotor = relative_speed(x)
    return Motion(
        rotor,
        wheel,
        x[X.VEHICLE_SPEED] if chain.kind == P.THREE_INERTIA else wheel,
        x[X.TWIST],
        x[X.HOUSING_SPEED] + rotor / chain.gear_ratio - wheel,
        L.stretched(x[X.TWIST], chain, memories, p),
        x[X.TYRE_TWIST],
        rotor_angle,
        wheel_angle,
    )
