"""The laws of all effects, put together to the functions that both integrators call.

Each law is compiled from its plain Python, with its own numbers cut out of the parameter vector. A law whose
effect a model does not have costs a comparison. What is put together here is made when a kernel is compiled
that calls it, not when a compiled one is loaded:

    shaft_force, rotor_loss, dry_friction, vehicle_load, tyre_force, tyre_rate
        one force of all effects together: (motion, chain, memories, p)
    shaft_leap
        what their torque is within a step beyond a straight line: (before, after, chain, memories, p, h)
    moves_shaft, slows_rotor, may_stick, loads, moves_tyre, remembers, turns, limits, pushes, leaps
        whether any effect that has such a law does anything: (p)
    shaped: the torque that a request becomes: (torque, p)
    limited: what the motor gives of it at the rotor's speed: (torque, speed, p)
    steepest: the steepest slope of the acting torque in N m/s: (p)
    stretched: what is left of a twist for the shafts: (twist, chain, memories, p)
    remembered: the memories after a step of h seconds: (before, after, chain, memories, p, h)
    started: memories at a start with a shaft torque, and their twist in series: (torque, chain, p)
    turned: memories at a start in motion: (speed, chain, memories, p)
"""

from __future__ import annotations

import dis
import types
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from numba import njit

from hil.core.effects import STRANGERS, Effect
from hil.core.runtime.compiled import depends_on
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._tuples import put

depends_on(STRANGERS)

_NO_LIMIT = float("inf")
_EMPTY = X.NO_MEMORY


def __getattr__(name: str) -> Any:
    if name not in _MAKERS:
        raise AttributeError(name)
    return _made(name)


@cache
def _made(name: str) -> Any:
    return _MAKERS[name]()


def _compile(function: Callable[..., Any]) -> Any:
    """Into its callers: as a function by itself it would be handed some hundred numbers, at each step."""
    return njit(error_model="numpy", forceinline=True)(function)


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


@cache
def _place(id_: str) -> _Place:
    effect = next(one for one in P.ACTING if one.id == id_)
    first = P.FIRST[id_]
    acts = None
    for slot, off in _numbers_of(effect):
        one = _differs(slot, off)
        acts = one if acts is None else _either(acts, one)
    return _Place(first, first + len(effect.parameters), X.MEMORY.get(id_, -1), acts)


def _numbers_of(effect: Effect) -> list[tuple[int, float]]:
    """(slot, value when off) of the numbers by which an effect acts."""
    return [(P.place(effect.id, name), float(effect.off)) for name in effect.acting()]


def _differs(slot: int, off: float) -> Any:
    def acts(p):  # type: ignore[no-untyped-def]
        return p[slot] != off

    return _compile(acts)


def _either(one: Any, other: Any) -> Any:
    def acts(p):  # type: ignore[no-untyped-def]
        return one(p) or other(p)

    return _compile(acts)


def _having(name: str) -> list[Effect]:
    return [effect for effect in P.ACTING if getattr(effect.law, name) is not None]


def _any_of(*names: str) -> Any:
    """Whether any of the effects with such laws does anything: asked before a loop, so one short function."""
    numbers = [number for name in names for effect in _having(name) for number in _numbers_of(effect)]
    slots, offs = tuple(slot for slot, _ in numbers), tuple(off for _, off in numbers)

    def acts(p):  # type: ignore[no-untyped-def]
        for i in range(len(slots)):  # noqa: SIM110 - no generators in compiled code
            if p[slots[i]] != offs[i]:
                return True
        return False

    def never(p):  # type: ignore[no-untyped-def]
        return False

    return _compile(acts if numbers else never)


def _force(effect: Effect, law: Any) -> Any:
    first, last, memory, acts = _place(effect.id)
    law = _law(law)
    if memory < 0:

        def force(motion, chain, memories, p):  # type: ignore[no-untyped-def]
            return law(motion, chain, 0.0, p[first:last]) if acts(p) else 0.0
    else:

        def force(motion, chain, memories, p):  # type: ignore[no-untyped-def]
            return law(motion, chain, memories[memory], p[first:last]) if acts(p) else 0.0

    return _compile(force)


def _plus(one: Any, other: Any) -> Any:
    def total(motion, chain, memories, p):  # type: ignore[no-untyped-def]
        return one(motion, chain, memories, p) + other(motion, chain, memories, p)

    return _compile(total)


def _sum_of(name: str) -> Any:
    def nothing(motion, chain, memories, p):  # type: ignore[no-untyped-def]
        return 0.0

    forces = [_force(effect, getattr(effect.law, name)) for effect in _having(name)]
    result = forces[0] if forces else _compile(nothing)
    for force in forces[1:]:
        result = _plus(result, force)
    return result


def _shaped(before: Any, effect: Effect) -> Any:
    first, last, _, acts = _place(effect.id)
    law = _law(effect.law.shape)  # type: ignore[arg-type]

    def shape(torque, p):  # type: ignore[no-untyped-def]
        torque = before(torque, p)
        return law(torque, p[first:last]) if acts(p) else torque

    return _compile(shape)


def _limited(before: Any, effect: Effect) -> Any:
    first, last, _, acts = _place(effect.id)
    law = _law(effect.law.limit)  # type: ignore[arg-type]

    def limit(torque, speed, p):  # type: ignore[no-untyped-def]
        torque = before(torque, speed, p)
        return law(torque, speed, p[first:last]) if acts(p) else torque

    return _compile(limit)


def _gentler(before: Any, effect: Effect) -> Any:
    first, last, _, acts = _place(effect.id)
    law = _law(effect.law.slope)  # type: ignore[arg-type]

    def slope(p):  # type: ignore[no-untyped-def]
        return min(before(p), law(p[first:last])) if acts(p) else before(p)

    return _compile(slope)


def _stretched(before: Any, effect: Effect) -> Any:
    first, last, memory, acts = _place(effect.id)
    law = _law(effect.law.stretch)  # type: ignore[arg-type]

    def stretch(twist, chain, memories, p):  # type: ignore[no-untyped-def]
        twist = before(twist, chain, memories, p)
        return law(twist, chain, memories[memory], p[first:last]) if acts(p) else twist

    return _compile(stretch)


def _remembered(others: Any, effect: Effect) -> Any:
    first, last, memory, acts = _place(effect.id)
    law = _law(effect.law.remember)  # type: ignore[arg-type]

    def remember(before, after, chain, memories, p, h):  # type: ignore[no-untyped-def]
        new = others(before, after, chain, memories, p, h)
        if acts(p):
            new = put(new, memory, law(before, after, chain, memories[memory], p[first:last], h))
        return new

    return _compile(remember)


def _leaping(others: Any, effect: Effect) -> Any:
    first, last, memory, acts = _place(effect.id)
    law = _law(effect.law.leap)  # type: ignore[arg-type]

    def leap(before, after, chain, memories, p, h):  # type: ignore[no-untyped-def]
        begins, rises = others(before, after, chain, memories, p, h)
        if acts(p):
            more, rise = law(before, after, chain, memories[memory] if memory >= 0 else 0.0, p[first:last], h)
            begins, rises = begins + more, rises + rise
        return begins, rises

    return _compile(leap)


def _begin_with(others: Any, effect: Effect) -> Any:
    first, last, memory, acts = _place(effect.id)
    law = _law(effect.law.begin)  # type: ignore[arg-type]
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


def _turned(others: Any, effect: Effect) -> Any:
    first, last, memory, acts = _place(effect.id)
    law = _law(effect.law.turned)  # type: ignore[arg-type]

    def turned(speed, chain, memories, p):  # type: ignore[no-untyped-def]
        memories = others(speed, chain, memories, p)
        return put(memories, memory, law(speed, chain, p[first:last])) if acts(p) else memories

    return _compile(turned)


def _in_turn(name: str, with_one_more: Callable[[Any, Effect], Any], first: Callable[..., Any]) -> Any:
    """All laws of one name, each around the ones before it."""
    result = _compile(first)
    for effect in _having(name):
        result = with_one_more(result, effect)
    return result


_MAKERS: dict[str, Callable[[], Any]] = {
    "shaft_force": lambda: _sum_of("shaft"),
    "rotor_loss": lambda: _sum_of("loss"),
    "dry_friction": lambda: _sum_of("dry"),
    "vehicle_load": lambda: _sum_of("load"),
    "tyre_force": lambda: _sum_of("tyre"),
    "tyre_rate": lambda: _sum_of("tyre_rate"),
    "moves_shaft": lambda: _any_of("shaft"),
    "slows_rotor": lambda: _any_of("loss"),
    "may_stick": lambda: _any_of("dry"),
    "loads": lambda: _any_of("load"),
    "moves_tyre": lambda: _any_of("tyre", "tyre_rate"),
    "remembers": lambda: _any_of("remember"),
    "turns": lambda: _any_of("follows"),
    "limits": lambda: _any_of("limit"),
    "leaps": lambda: _any_of("leap"),
    "pushes": lambda: _any_of("shaft", "loss", "dry", "load", "tyre", "tyre_rate"),
    "shaped": lambda: _in_turn("shape", _shaped, lambda torque, p: torque),
    "limited": lambda: _in_turn("limit", _limited, lambda torque, speed, p: torque),
    "steepest": lambda: _in_turn("slope", _gentler, lambda p: _NO_LIMIT),
    "stretched": lambda: _in_turn("stretch", _stretched, lambda twist, chain, memories, p: twist),
    "shaft_leap": lambda: _in_turn("leap", _leaping, lambda before, after, chain, memories, p, h: (0.0, 0.0)),
    "remembered": lambda: _in_turn(
        "remember", _remembered, lambda before, after, chain, memories, p, h: memories
    ),
    "initial": lambda: _in_turn("begin", _begin_with, lambda torque, chain, p: (_EMPTY, 0.0)),
    "turned": lambda: _in_turn("turned", _turned, lambda speed, chain, memories, p: memories),
}
