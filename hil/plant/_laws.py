"""The laws of all effects, put together to the functions that both integrators call.

Each law is compiled from its plain Python with its own numbers cut out of the parameter vector. A law whose
effect a model does not have costs a comparison, which the compiler moves out of loops.
"""

from __future__ import annotations

import dis
import types
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from numba import njit

from hil.core.chain import Chain
from hil.core.compiled import FAST, inlined
from hil.core.effects import Effect, Motion
from hil.plant import _slots as P
from hil.plant import _states as X
from hil.plant._tuples import put

_CHAIN = P.CHAIN


def _compile(function: Callable[..., Any]) -> Any:
    return njit(error_model="numpy", fastmath=FAST)(function)


@cache
def _law(function: Callable[..., Any]) -> Any:
    """A plain function compiled, with the plain functions that it calls."""
    called = {
        name: _law(value)
        for name in _globals_of(function)
        if isinstance(value := function.__globals__.get(name), types.FunctionType)
    }
    own = types.FunctionType(
        function.__code__, {**function.__globals__, **called}, function.__name__, function.__defaults__
    )
    own.__module__, own.__qualname__ = function.__module__, function.__qualname__
    return _compile(own)


def _globals_of(function: Callable[..., Any]) -> set[str]:
    return {i.argval for i in dis.get_instructions(function) if i.opname == "LOAD_GLOBAL"}


class _Place(NamedTuple):
    """Where an effect's numbers stand."""

    first: int
    last: int
    memory: int  # -1: it keeps none
    acts: Any  # compiled: whether the effect does anything, of the parameter vector


def _differs(slot: int, off: float) -> Any:
    def acts(p):  # type: ignore[no-untyped-def]
        return p[slot] != off

    return _compile(acts)


def _either(one: Any, other: Any) -> Any:
    def acts(p):  # type: ignore[no-untyped-def]
        return one(p) or other(p)

    return _compile(acts)


def _place(effect: Effect) -> _Place:
    first = P.FIRST[effect.id]
    acts = None
    for name in effect.acting():
        one = _differs(P.place(effect.id, name), effect.off)
        acts = one if acts is None else _either(acts, one)
    return _Place(first, first + len(effect.parameters), X.MEMORY.get(effect.id, -1), acts)


PLACES = {effect.id: _place(effect) for effect in P.ACTING}


def _force(effect: Effect, law: Any) -> Any:
    """One force of one effect: (motion, chain, memories, p)."""
    first, last, memory, acts = PLACES[effect.id]
    law = _law(law)
    if memory < 0:

        def force(motion, chain, memories, p):  # type: ignore[no-untyped-def]
            return law(motion, chain, 0.0, p[first:last]) if acts(p) else 0.0
    else:

        def force(motion, chain, memories, p):  # type: ignore[no-untyped-def]
            return law(motion, chain, memories[memory], p[first:last]) if acts(p) else 0.0

    return _compile(force)


def _sum_of(name: str) -> Any:
    """One force of all effects together: (motion, chain, memories, p)."""

    def total(motion, chain, memories, p):  # type: ignore[no-untyped-def]
        return 0.0

    result = _compile(total)
    for effect in P.ACTING:
        law = getattr(effect.law, name)
        if law is not None:
            result = _plus(result, _force(effect, law))
    return result


def _plus(one: Any, other: Any) -> Any:
    def total(motion, chain, memories, p):  # type: ignore[no-untyped-def]
        return one(motion, chain, memories, p) + other(motion, chain, memories, p)

    return _compile(total)


shaft_force, rotor_loss, dry_friction = _sum_of("shaft"), _sum_of("loss"), _sum_of("dry")
vehicle_load, tyre_force, tyre_rate = _sum_of("load"), _sum_of("tyre"), _sum_of("tyre_rate")


def _acting(*names: str) -> Any:
    """Whether any effect that has one of these laws does anything: (p)."""

    def acts(p):  # type: ignore[no-untyped-def]
        return False

    result = _compile(acts)
    for effect in P.ACTING:
        if any(getattr(effect.law, name) is not None for name in names):
            result = _either(result, PLACES[effect.id].acts)
    return result


turns = _compile(lambda p: False)
for _effect in P.ACTING:
    if _effect.law.follows is not None:
        turns = _either(turns, PLACES[_effect.id].acts)
moves_tyre = _acting("tyre", "tyre_rate")
may_stick = _acting("dry")
pushes = _acting("shaft", "loss", "dry", "load", "tyre", "tyre_rate")
_moves_shaft, _slows_rotor, _loads = _acting("shaft"), _acting("loss"), _acting("load")
_remembers = _acting("remember")


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
    return Acting(_moves_shaft(p), _slows_rotor(p), _loads(p), moves_tyre(p), may_stick(p), _remembers(p))


def _shaped(before: Any, effect: Effect) -> Any:
    first, last, _, acts = PLACES[effect.id]
    law = _law(effect.law.shape)

    def shape(torque, p):  # type: ignore[no-untyped-def]
        torque = before(torque, p)
        return law(torque, p[first:last]) if acts(p) else torque

    return _compile(shape)


shaped = _compile(lambda torque, p: torque)
for _effect in P.ACTING:
    if _effect.law.shape is not None:
        shaped = _shaped(shaped, _effect)


def _gentler(before: Any, effect: Effect) -> Any:
    first, last, _, acts = PLACES[effect.id]
    law = _law(effect.law.slope)

    def slope(p):  # type: ignore[no-untyped-def]
        return min(before(p), law(p[first:last])) if acts(p) else before(p)

    return _compile(slope)


_NO_LIMIT = float("inf")
steepest = _compile(lambda p: _NO_LIMIT)
for _effect in P.ACTING:
    if _effect.law.slope is not None:
        steepest = _gentler(steepest, _effect)


def _stretched(before: Any, effect: Effect) -> Any:
    first, last, memory, acts = PLACES[effect.id]
    law = _law(effect.law.stretch)

    def stretch(twist, chain, memories, p):  # type: ignore[no-untyped-def]
        twist = before(twist, chain, memories, p)
        return law(twist, chain, memories[memory], p[first:last]) if acts(p) else twist

    return _compile(stretch)


stretched = _compile(lambda twist, chain, memories, p: twist)
for _effect in P.ACTING:
    if _effect.law.stretch is not None:
        stretched = _stretched(stretched, _effect)


def _with_memory(others: Any, effect: Effect) -> Any:
    first, last, memory, acts = PLACES[effect.id]
    law = _law(effect.law.remember)

    def remember(before, after, chain, memories, p, h):  # type: ignore[no-untyped-def]
        new = others(before, after, chain, memories, p, h)
        if acts(p):
            new = put(new, memory, law(before, after, chain, memories[memory], p[first:last], h))
        return new

    return _compile(remember)


remembered = _compile(lambda before, after, chain, memories, p, h: memories)
for _effect in P.ACTING:
    if _effect.law.remember is not None:
        remembered = _with_memory(remembered, _effect)


def _beginning(others: Any, effect: Effect) -> Any:
    first, last, memory, acts = PLACES[effect.id]
    law = _law(effect.law.begin)
    in_series = effect.law.stretch is not None

    def begin(torque, chain, p):  # type: ignore[no-untyped-def]
        memories, twist = others(torque, chain, p)
        if acts(p):
            value = law(torque, chain, p[first:last])
            memories = put(memories, memory, value)
            if in_series:
                twist += value
        return memories, twist

    return _compile(begin)


_EMPTY = X.NO_MEMORY
#: Memories at a start with a shaft torque, and their twist in series with the shafts: (torque, chain, p).
begun = _compile(lambda torque, chain, p: (_EMPTY, 0.0))
for _effect in P.ACTING:
    if _effect.law.begin is not None:
        begun = _beginning(begun, _effect)


@inlined
def chain_of(p):  # type: ignore[no-untyped-def]
    """The linear numbers of a packed model by their names."""
    return Chain(
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15]
    )


@inlined
def turning(speed):  # type: ignore[no-untyped-def]
    """What a law of dry friction is told: the rotor turns against the housing, all else is at rest."""
    return Motion(speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@inlined
def motion_of(x, chain, memories, wheel_angle, rotor_angle, p):  # type: ignore[no-untyped-def]
    """What laws are told of a state."""
    wheel = x[X.WHEEL_SPEED]
    rotor = x[X.ROTOR_SPEED] - x[X.HOUSING_SPEED]
    return Motion(
        rotor,
        wheel,
        x[X.VEHICLE_SPEED] if chain.kind == P.THREE_INERTIA else wheel,
        x[X.TWIST],
        x[X.HOUSING_SPEED] + rotor / chain.gear_ratio - wheel,
        stretched(x[X.TWIST], chain, memories, p),
        x[X.TYRE_TWIST],
        rotor_angle,
        wheel_angle,
    )
