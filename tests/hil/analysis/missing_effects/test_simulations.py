"""What simulations may cost: processor time that ends a search, outputs that are kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from hil.analysis.missing_effects._fit import fit, point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._simulations import Allowance, OutOfTimeError, Shown
from tests.hil.analysis.missing_effects.chain import chirp_problem


def test_what_is_used_up_ends_every_fit_until_it_is_lifted() -> None:
    spent = Allowance(-1.0)
    free = chirp_problem(1.1)
    problem = replace(free, allowance=spent)
    point = point_at(free, Hypothesis(problem.model, dict(problem.model.parameters)))
    with pytest.raises(OutOfTimeError):
        fit(problem, point, evaluations=2)
    spent.lift()
    assert fit(problem, point, evaluations=2).hypothesis is not point.hypothesis


def test_without_a_bound_nothing_ends() -> None:
    Allowance().check()


Array = npt.NDArray[np.float64]


class _Plant:
    """Shows each key's number, and counts what it is asked for."""

    def __init__(self, keys: list[int]) -> None:
        self.keys = keys
        self.asked: list[int] = []

    def simulate(self, places: npt.NDArray[np.int64]) -> Array:
        some = [self.keys[place] for place in places.tolist()]
        self.asked += some
        return np.array(some, dtype=float)[:, None, None] * np.ones((1, 4, 3))


def _outputs(shown: Shown, keys: list[int], *, keep: bool = True) -> tuple[list[float], list[int]]:
    plant = _Plant(keys)
    found = shown.outputs(keys, plant.simulate, keep=keep)
    return found[:, 0, 0].tolist(), plant.asked


def test_what_was_shown_is_not_simulated_again() -> None:
    shown = Shown()
    assert _outputs(shown, [1, 2]) == ([1.0, 2.0], [1, 2])
    assert _outputs(shown, [3, 2, 1]) == ([3.0, 2.0, 1.0], [3])
    assert _outputs(shown, [3]) == ([3.0], [])


def test_models_that_are_alike_are_simulated_once() -> None:
    assert _outputs(Shown(), [5, 6, 5]) == ([5.0, 6.0, 5.0], [5, 6])


def test_what_is_not_worth_it_is_not_kept() -> None:
    shown = Shown()
    _outputs(shown, [1], keep=False)
    assert _outputs(shown, [1]) == ([1.0], [1])


def test_the_oldest_are_dropped() -> None:
    one = 4 * 3 * 8
    shown = Shown(most_bytes=2 * one)
    for key in (1, 2):
        _outputs(shown, [key])
    _outputs(shown, [1])
    _outputs(shown, [3])
    assert _outputs(shown, [1]) == ([1.0], [])
    assert _outputs(shown, [2]) == ([2.0], [2])
