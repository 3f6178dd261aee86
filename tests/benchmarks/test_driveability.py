"""Limits of `driveability` and `abs_release` lie where they are said to, beyond the fitted model's values."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from benchmarks.driveability import PLANS, SHARES, Derived, derived, manoeuvre, misplaced
from test_plans import load_plan
from test_plans.loading import LIBRARY

SPEEDS = (10, 20, 30, 50, 80)
JERK_OF_A_DRIVER = 1.2 * 9.81  # m/s³, the careful driver of UN Regulation 157
CAUTION = 8.5  # m/s^1.75 a day, where annex B of ISO 2631-1 begins its health caution zone


@pytest.fixture(scope="module")
def found() -> list[Derived]:
    return [one for name in PLANS for one in derived(name)]


@pytest.mark.slow
def test_each_limit_is_derived_as_stated(found: list[Derived]) -> None:
    assert [one.criterion.id for one in found if misplaced(one)] == []


@pytest.mark.slow
@pytest.mark.parametrize("by", [0.95, 1.05])
def test_a_limit_that_is_moved_by_five_percent_is_noticed(found: list[Derived], by: float) -> None:
    unnoticed = []
    for one in found:
        own = one.criterion
        side = "upper" if own.lower is None else "lower"
        moved = own.model_copy(update={side: getattr(own, side) * by})
        if not misplaced(replace(one, criterion=moved)):
            unnoticed.append(own.id)
    assert unnoticed == []


@pytest.mark.slow
def test_every_limit_binds_and_public_targets_are_kept(found: list[Derived]) -> None:
    for one in found:
        own = one.criterion
        limit = own.upper if own.lower is None else own.lower
        assert (own.upper is None) != (own.lower is None)
        assert limit is not None
        # within a share of the value, or within noise of it where that is more
        assert abs(limit - one.value) <= max(1.05 * SHARES[own.metric.name] * abs(one.value), 8.5), own.id
        if own.metric.name == "jerk":
            assert limit < JERK_OF_A_DRIVER
        if own.metric.name == "vibration_dose":
            assert (CAUTION / limit) ** 4 > 100_000  # so many such steps a day


def test_each_manoeuvre_is_driven_at_five_speeds_and_is_judged() -> None:
    plan = load_plan("driveability")
    ids = [segment.id for segment in plan.segments]
    for name in ("tip_in", "tip_out", "back_out", "change_of_mind", "regen_to_drive"):
        assert [one for one in ids if manoeuvre(one) == name] == [f"{name}_{speed}" for speed in SPEEDS]
    assert {criterion.segment for criterion in plan.criteria} == set(ids)
    assert all(criterion.upper is not None or criterion.lower is not None for criterion in plan.criteria)
    rates = {
        one.id: (one.reference_after - one.reference_before) / one.rise_s
        for one in plan.segments
        if one.rise_s
    }
    for name, rate in rates.items():
        assert math.isclose(rate, float(name.removeprefix("ramp_")), rel_tol=0.005)


def test_the_plan_says_what_it_leaves_out() -> None:
    text = (LIBRARY / "driveability.yaml").read_text("utf-8")
    for word in ("low friction", "split friction", "anti-lock", "kerbs"):
        assert word in text


def test_a_modulation_is_judged_from_its_first_release_on() -> None:
    """The step of stairs is their last level: alone it would leave out two releases of three."""
    plan = load_plan("abs_release")
    for name in ("modulation_20", "modulation_50", "modulation_80"):
        since = {
            one.metric.name: getattr(one.metric, "since", "") for one in plan.criteria if one.segment == name
        }
        assert [metric for metric, begin in since.items() if begin == "first_change"] == [
            "magnitude",
            "jerk",
            "vibration_dose",
        ]
    for one in load_plan("driveability").criteria:
        if manoeuvre(one.segment) == "change_of_mind" and one.metric.name in (
            "jerk",
            "time_in_play",
            "clunk",
        ):
            assert getattr(one.metric, "since", "") == "first_change", one.id
