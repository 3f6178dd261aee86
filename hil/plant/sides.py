"""Both sides of the axle: what differs from left to right, beside the chain of both together.

The state of the chain has sums of torques and means of angles and speeds. With `separate_wheels` there are
four further states, half of the difference left less right: the twist θ of the shafts, the speed w of the
wheels, the twist y of the tyres, the angle of the wheels. With T half of the difference of the shafts'
torques, R_l and R_r what the tyres take and B_l and B_r what brakes the wheels from outside,

    J_w·w' = 2·T - (R_l - R_r) - (B_l - B_r),    y' = w + (s_l - s_r) / 2,    T = k/2·θ + c/2·θ'

where s is the rate at which a tyre's contact slides, and k and c are both shafts' together. The differential
holds its side gears together (θ' = -w) until 2·T reaches its friction; an open one gives T = 0. What the
tyres take together, and how their twist changes in the mean, differ from the chain's own where the sides
differ: that difference is added to it, and is zero to the last bit where they do not.

Which equations a kernel has is chosen when it is compiled, by the length of its state: an axle whose sides
are alike does not pay for two.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from numba.extending import overload

from hil.core.errors import BadInputError
from hil.core.runtime.compiled import chosen_by_type, inlined
from hil.plant import _equations as E
from hil.plant import _laws as L
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._motion import acting_of, chain_of
from hil.plant._tuples import put

if TYPE_CHECKING:
    from hil.core.model import Model

EFFECT = "separate_wheels"
SHAFT, SPEED, TYRE, ANGLE = range(X.MOVING, X.MOVING + 4)
#: States at rest: of the chain alone, and with both sides. Their lengths choose what is compiled.
LUMPED, SEPARATE = X.AT_REST, (*X.AT_REST, 0.0, 0.0, 0.0, 0.0)

_FRICTION = P.place(EFFECT, "differential_friction_nm")
FRICTION_LEFT, FRICTION_RIGHT = P.place(EFFECT, "friction_left"), P.place(EFFECT, "friction_right")
_SLIDES_AT = P.place("tyre_friction", "peak_nm"), P.place("tyre_friction", "sliding_nm")
_OPTIONS = {"error_model": "numpy", "forceinline": True}


def form_of(model: Model) -> tuple[float, ...]:
    """The state at rest that a model has: SEPARATE or LUMPED."""
    return SEPARATE if any(use.id == EFFECT for use in model.effects) else LUMPED


def refuse_separate(model: Model, what: str) -> None:
    """Refuse a model with separate wheels where only both together are simulated.

    Raises:
        BadInputError: it has them; names the model and `what` cannot take it.
    """
    if form_of(model) is SEPARATE:
        raise BadInputError(
            f"{what} knows both wheels together only, the model has '{EFFECT}'",
            where=model.source or "the model",
            fix=f"remove '{EFFECT}', or run a plan on a simulated bench with this model",
        )


@inlined
def _on_side(x, p, side):  # type: ignore[no-untyped-def]
    """State and numbers of an axle both of whose sides are as one is: left 1, right -1."""
    x = put(x, X.WHEEL_SPEED, x[X.WHEEL_SPEED] + side * x[SPEED])
    x = put(x, X.TYRE_TWIST, x[X.TYRE_TWIST] + side * x[TYRE])
    share = p[FRICTION_LEFT] if side > 0.0 else p[FRICTION_RIGHT]
    for_side = put(p, _SLIDES_AT[0], share * p[_SLIDES_AT[0]])
    return x, put(for_side, _SLIDES_AT[1], share * p[_SLIDES_AT[1]])


@inlined
def _road(x, chain, memories, p, acting):  # type: ignore[no-untyped-def]
    """What the tyres of an axle take (N m), and how fast their contact slides (rad/s)."""
    m = E.motion(x, chain, memories, p)
    slides = L.tyre_rate(m, chain, memories, p) if acting.tyre else 0.0
    return E.tyre_torque(x, m, chain, memories, p, acting), slides


@inlined
def _roads(x, chain, memories, p, acting):  # type: ignore[no-untyped-def]
    """Half of each of both, left and right: torque (N m), sliding (rad/s)."""
    left, for_left = _on_side(x, p, 1.0)
    right, for_right = _on_side(x, p, -1.0)
    torque_left, slides_left = _road(left, chain, memories, for_left, acting)
    torque_right, slides_right = _road(right, chain, memories, for_right, acting)
    return 0.5 * torque_left, 0.5 * torque_right, 0.5 * slides_left, 0.5 * slides_right


@inlined
def _shaft(x, chain, p):  # type: ignore[no-untyped-def]
    """ΔT in N m, and the rate of θ_s in rad/s."""
    most = 0.5 * p[_FRICTION]
    held = 0.5 * chain.shaft_stiffness * x[SHAFT]
    rate = -x[SPEED]
    torque = held + 0.5 * chain.shaft_damping * rate
    if torque > most:
        return most, min(rate, 0.0)
    if torque < -most:
        return -most, max(rate, 0.0)
    return torque, rate


@chosen_by_type
def derivative(x, memories, p, acting, torque, coupled, load, direction):  # type: ignore[no-untyped-def]
    """dx/dt of the chain, or of both sides; `load` is then its sum and its difference, left less right."""
    chosen: Any = _lumped if len(x) == len(LUMPED) else _separate
    return chosen(x, memories, p, acting, torque, coupled, load, direction)


@overload(derivative, jit_options=_OPTIONS)
def _derivative(x, memories, p, acting, torque, coupled, load, direction):  # type: ignore[no-untyped-def]
    del memories, p, acting, torque, coupled, load, direction
    return _lumped if len(x) == len(LUMPED) else _separate


def _lumped(x, memories, p, acting, torque, coupled, load, direction):  # type: ignore[no-untyped-def]
    return E.derivative(x, memories, p, acting, torque, coupled, load, direction)


def _separate(x, memories, p, acting, torque, coupled, load, direction):  # type: ignore[no-untyped-def]
    chain = chain_of(p)
    slope = E.derivative(x, memories, p, acting, torque, coupled, load[0], direction)
    shaft, shaft_rate = _shaft(x, chain, p)
    drives = 2.0 * shaft - load[1]
    tyre_rate = 0.0
    if coupled:
        left, right, slides_left, slides_right = _roads(x, chain, memories, p, acting)
        both, slides = _road(x, chain, memories, p, acting)
        more = (left + right) - both
        slope = put(slope, X.WHEEL_SPEED, slope[X.WHEEL_SPEED] - more / chain.wheel_inertia)
        slope = put(slope, X.VEHICLE_SPEED, slope[X.VEHICLE_SPEED] + more / chain.vehicle_inertia)
        slope = put(slope, X.TYRE_TWIST, slope[X.TYRE_TWIST] + ((slides_left + slides_right) - slides))
        drives -= left - right
        tyre_rate = x[SPEED] + (slides_left - slides_right)
    return (*slope, shaft_rate, drives / chain.wheel_inertia, tyre_rate, x[SPEED])


@chosen_by_type
def differences(x, memories, p, coupled):  # type: ignore[no-untyped-def]
    """Half of the difference, left less right: wheels (rad/s), shafts, what the tyres take (N m).

    And what the tyres take together beyond what the chain says, N m.
    """
    chosen: Any = _no_differences if len(x) == len(LUMPED) else _differences_of_sides
    return chosen(x, memories, p, coupled)


@overload(differences, jit_options=_OPTIONS)
def _differences(x, memories, p, coupled):  # type: ignore[no-untyped-def]
    del memories, p, coupled
    return _no_differences if len(x) == len(LUMPED) else _differences_of_sides


def _no_differences(x, memories, p, coupled):  # type: ignore[no-untyped-def] # noqa: ARG001
    return 0.0, 0.0, 0.0, 0.0


def _differences_of_sides(x, memories, p, coupled):  # type: ignore[no-untyped-def]
    chain = chain_of(p)
    shaft, _ = _shaft(x, chain, p)
    taken, more = 0.0, 0.0
    if coupled:
        acting = acting_of(p)
        left, right, _, _ = _roads(x, chain, memories, p, acting)
        both, _ = _road(x, chain, memories, p, acting)
        taken, more = 0.5 * (left - right), (left + right) - both
    return x[SPEED], shaft, taken, more


@chosen_by_type
def loads(x, left, right):  # type: ignore[no-untyped-def]
    """What brakes the wheels, as `derivative` takes it for a state like `x`."""
    chosen: Any = _sum_of if len(x) == len(LUMPED) else _sum_and_difference
    return chosen(x, left, right)


@overload(loads, jit_options=_OPTIONS)
def _loads(x, left, right):  # type: ignore[no-untyped-def]
    del left, right
    return _sum_of if len(x) == len(LUMPED) else _sum_and_difference


def _sum_of(x, left, right):  # type: ignore[no-untyped-def] # noqa: ARG001
    return left + right


def _sum_and_difference(x, left, right):  # type: ignore[no-untyped-def] # noqa: ARG001
    return left + right, left - right
