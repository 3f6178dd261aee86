"""Which of two fits is preferred: what they leave, and what their numbers cost."""

from __future__ import annotations

from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.search._thresholds import DOUBT, EARLY, FAR, PRICE
from hil.core.effects import EFFECTS, Stage

_SENSOR_FAULTS = tuple(e.id for e in EFFECTS.values() if e.stage is Stage.SENSOR)


def price(one: Fit) -> float:
    """What the numbers of a fit cost, in squared errors over the noise variance."""
    return PRICE * len(one.theta)


def rank(one: Fit) -> float:
    """Total and a price of every number: smaller is better.

    Far from the noise formulas differ, and a small advantage of a fault in a sensor says nothing. No channel
    is recorded before it happens: where dead time is free, one that is early is as good as another that is
    late.
    """
    if doubted(one):
        return DOUBT * one.total + price(one)
    return (EARLY if _early(one) else 1.0) * one.total + price(one)


def doubted(one: Fit) -> bool:
    """Whether a fault in a sensor is among the names, and so much is left that formulas differ."""
    return one.total > FAR * one.rows and any(id_ in _SENSOR_FAULTS for id_ in one.hypothesis.ids)


def _early(one: Fit) -> bool:
    """Whether a channel is recorded early."""
    coordinates = one.hypothesis.coordinates()
    return any(c.name == "delay_s" and value < 0.0 for c, value in zip(coordinates, one.theta, strict=True))
