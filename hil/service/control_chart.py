"""Rules of control charts: what tells a drift before a limit is reached.

Five of the tests of Nelson (Journal of Quality Technology 16, 1984) for a chart of individual values. The
first, fifth and sixth are those of the Western Electric handbook (1956); its fourth wants eight values on one
side, Nelson's second nine. With a mean and a deviation that are known, chance breaks each once in some 250 to
500 values.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

Rule = Literal["nelson_1", "nelson_2", "nelson_3", "nelson_5", "nelson_6"]

_ON_ONE_SIDE, _IN_ONE_DIRECTION = 9, 6


@dataclass(frozen=True)
class Signal:
    """A rule that values broke, `first` to `last` among them, both included."""

    rule: Rule
    first: int
    last: int


TEXTS: dict[Rule, str] = {
    "nelson_1": "one value beyond three deviations",
    "nelson_2": "nine values in a row on one side of the mean",
    "nelson_3": "six values in a row rising or falling",
    "nelson_5": "two of three values beyond two deviations on one side",
    "nelson_6": "four of five values beyond one deviation on one side",
}


def signals(values: Sequence[float], mean: float, deviation: float) -> list[Signal]:
    """Every rule that is broken, each once for a stretch in which it is broken again and again.

    Args:
        values: in the order in which they were measured.
        deviation: of a single value, above 0; else none is broken.
    """
    if not deviation > 0:
        return []
    scores = [(value - mean) / deviation for value in values]
    found = []
    for rule, length, is_broken in _RULES:
        found += _stretches(rule, length, is_broken, scores)
    return sorted(found, key=lambda one: (one.last, one.first))


def _stretches(
    rule: Rule, length: int, is_broken: Callable[[Sequence[float]], bool], scores: Sequence[float]
) -> list[Signal]:
    """Windows that overlap are one."""
    found: list[Signal] = []
    for last in range(length - 1, len(scores)):
        first = last - length + 1
        if not is_broken(scores[first : last + 1]):
            continue
        if found and first <= found[-1].last:
            found[-1] = Signal(rule, found[-1].first, last)
        else:
            found.append(Signal(rule, first, last))
    return found


def _some_beyond(count: int, deviations: float) -> Callable[[Sequence[float]], bool]:
    """Whether so many are beyond so many deviations on one side, the newest among them."""

    def is_broken(window: Sequence[float]) -> bool:
        side = 1 if window[-1] > 0 else -1
        beyond = [side * score > deviations for score in window]
        return beyond[-1] and sum(beyond) >= count

    return is_broken


def _rises_or_falls(window: Sequence[float]) -> bool:
    steps = [after - before for before, after in itertools.pairwise(window)]
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)


_RULES: tuple[tuple[Rule, int, Callable[[Sequence[float]], bool]], ...] = (
    ("nelson_1", 1, _some_beyond(1, 3.0)),
    ("nelson_2", _ON_ONE_SIDE, _some_beyond(_ON_ONE_SIDE, 0.0)),
    ("nelson_3", _IN_ONE_DIRECTION, _rises_or_falls),
    ("nelson_5", 3, _some_beyond(2, 2.0)),
    ("nelson_6", 5, _some_beyond(4, 1.0)),
)


#: How many values it takes to break each rule.
LENGTHS: dict[str, int] = {rule: length for rule, length, _ in _RULES}
