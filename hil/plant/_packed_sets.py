"""Packed models of one simulation, many at once: how each begins, what its forces vary with."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt

from hil.core.chain import Chain
from hil.core.effects import EFFECTS, Effect
from hil.plant import slots as P

Array = npt.NDArray[np.float64]

SPEED, WHEEL, SHAFT = range(3)  # of the channels, and of a start
VEHICLE, TYRE = 3, 4  # of a start alone
STARTS = 5
CONSTANT, BY_ANGLE, BY_MOTION = range(3)  # what forces vary with; an angle alone may be known beforehand


def begins_of(parameters: Array, starts: Array) -> Array:
    """Starts (sets x 3 or 5) as packed models have them: 0 for what a kind has no state of; sets x 5."""
    begin = np.zeros((len(parameters), STARTS))
    begin[:, : starts.shape[1]] = starts
    kind = parameters[:, P.KIND]
    begin[kind != P.THREE_INERTIA, VEHICLE:] = 0.0
    begin[kind == P.RIGID, WHEEL:] = 0.0
    return begin


def turns(parameters: Array) -> npt.NDArray[np.bool_]:
    """Which of packed models (sets x slots) have a force that follows an angle."""
    found, on = np.zeros(len(parameters), dtype=bool), parameters != P.pack_nothing()
    for effect in _acting_anywhere(on):
        if effect.law.follows is not None:
            found |= np.any(on[:, _places(effect.id)], axis=1)
    return found


def parts_of(parameters: Array, dt: float) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """In how many parts each model's samples are cut, and what its forces vary with (`CONSTANT` …)."""
    steps = np.ones(len(parameters), np.int64)
    varies = np.full(len(parameters), CONSTANT, np.int64)
    on = parameters != P.pack_nothing()
    for effect in _acting_anywhere(on):
        law, first = effect.law, P.FIRST[effect.id]
        own = parameters[:, first : first + len(effect.parameters)]
        acts = np.any(on[:, _places(effect.id)], axis=1)
        if any(one is not None for one in (law.shape, law.limit, law.slope)):
            continue
        steady = law.steady(tuple(own.T)) if law.steady is not None else False
        with_what = BY_MOTION if law.follows is None else BY_ANGLE
        varies = np.where(acts & ~np.asarray(steady), np.maximum(varies, with_what), varies)
        if law.steps is not None:
            for index in np.flatnonzero(acts):
                p = parameters[index]
                cut = law.steps(Chain(*p[: P.CHAIN]), tuple(own[index]), dt)
                steps[index] = max(steps[index], cut)
    return steps, varies


@cache
def _places(effect: str) -> list[int]:
    """Slots of the numbers by which an effect acts."""
    return [P.place(effect, name) for name in EFFECTS[effect].acting()]


def _acting_anywhere(on: npt.NDArray[np.bool_]) -> list[Effect]:
    """Effects of which any set has a number that is not off (`on`, sets x slots)."""
    anywhere = np.any(on, axis=0).tolist()
    return [one for one in P.ACTING if any(anywhere[place] for place in _places(one.id))]
