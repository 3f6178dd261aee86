"""Rules of control charts: what each is broken by, what it is not, and how often chance breaks one."""

from __future__ import annotations

import numpy as np
import pytest

from hil.service.control_chart import TEXTS, Rule, Signal, signals

_QUIET = [0.3, -0.4, 0.2, -0.1, 0.5, -0.6]


def broken(values: list[float]) -> dict[str, tuple[int, int]]:
    return {one.rule: (one.first, one.last) for one in signals(values, 0.0, 1.0)}


@pytest.mark.parametrize(
    ("rule", "values", "almost"),
    [
        ("nelson_1", [3.1], [2.9]),
        ("nelson_2", [0.1] * 5 + [0.2] * 4, [0.1] * 8 + [-0.2]),
        ("nelson_3", [-0.5, -0.3, -0.1, 0.1, 0.3, 0.5], [-0.5, -0.3, -0.1, -0.1, 0.3, 0.5]),
        ("nelson_5", [-2.1, 0.0, -2.1], [-2.1, 0.0, 2.1]),
        ("nelson_6", [1.1, 1.1, -1.5, 1.1, 1.1], [1.1, 1.1, -1.5, 0.9, 1.1]),
    ],
)
def test_each_rule_is_broken_by_its_pattern_on_either_side_and_not_by_almost_that(
    rule: Rule, values: list[float], almost: list[float]
) -> None:
    stretch = (len(_QUIET), len(_QUIET) + len(values) - 1)
    # what came before can belong to the pattern where that is a run of one sign
    before = _QUIET if _QUIET[-1] * values[0] < 0 or rule != "nelson_2" else [-one for one in _QUIET]
    for sign in (1.0, -1.0):
        found = broken([sign * one for one in before + values])
        assert found[rule][1] == stretch[1]
        assert found[rule][0] >= stretch[0] - 1
        assert rule not in broken([sign * one for one in before + almost])


def test_a_stretch_is_told_once() -> None:
    assert signals([0.1] * 20, 0.0, 1.0) == [Signal("nelson_2", 0, 19)]


def test_without_scatter_nothing_is_told() -> None:
    assert signals([1.0] * 20, 1.0, 0.0) == []


def test_a_drift_is_told_before_it_reaches_the_limit() -> None:
    draws = np.random.default_rng(2)
    values = np.r_[draws.normal(0, 1, 60), draws.normal(0, 1, 30) + np.linspace(0, 4, 30)]
    assert np.all(values < 6)  # the limit
    first = min(one.last for one in signals(values.tolist(), 0.0, 1.0) if one.first >= 60)
    assert first < 80


def test_chance_breaks_a_rule_as_seldom_as_it_says() -> None:
    values = np.random.default_rng(1).normal(size=40_000).tolist()
    counts = dict.fromkeys(TEXTS, 0)
    for one in signals(values, 0.0, 1.0):
        counts[one.rule] += 1
    assert counts["nelson_1"] == pytest.approx(40_000 * 0.0027, rel=0.3)
    assert all(40_000 / count > 200 for count in counts.values()), counts
