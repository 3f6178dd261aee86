"""Friction and contact by the laws of other authors: the form that data show, and no more numbers."""

import pytest

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import Fit, fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._evidence import Evidence
from hil.analysis.diagnosis.search._growth import grown
from hil.analysis.diagnosis.search._optional import refined
from hil.analysis.diagnosis.search._screen import screen
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def use(id_: str, **values: float) -> EffectUse:
    return EffectUse(id_, EFFECTS[id_].check(values, "here"))


def fitted(problem: Problem, told: EffectUse, *open_: str) -> tuple[Evidence, Fit]:
    evidence = Evidence(problem, fit(problem, Hypothesis(MODEL)))
    return evidence, fit(problem, Hypothesis(MODEL, (told,), open_))


def values_of(one: Fit) -> dict[str, float]:
    return {name: float(value) for name, value in one.hypothesis.model(one.theta).effects[0].values.items()}


@pytest.mark.slow
def test_a_small_gap_whose_flanks_pull_is_scored_as_such_and_not_as_damping_of_the_shafts() -> None:
    hidden = use("backlash", half_gap_rad=0.003, contact_damping_nms_rad=12.0, tension=1.0)
    problem = one_problem(hidden)
    base = fit(problem, Hypothesis(MODEL))
    first = screen(problem, base)[0]
    assert first.key == ("backlash", "")
    assert first.use.values["tension"] == 1.0
    found = grown(problem, base, first.use, 14)
    assert "contact_damping_nms_rad" in found.hypothesis.open
    values = values_of(found)
    assert values["half_gap_rad"] == pytest.approx(0.003, rel=0.05)
    assert values["contact_damping_nms_rad"] == pytest.approx(12.0, rel=0.1)


def test_flanks_that_were_taken_to_let_go_are_found_to_pull() -> None:
    told = {"half_gap_rad": 0.01, "contact_damping_nms_rad": 30.0}
    problem = one_problem(use("backlash", **told, tension=1.0))
    evidence, one = fitted(problem, use("backlash", **told), "contact_damping_nms_rad")
    assert not evidence.closed(one)
    found = refined(problem, evidence, one)
    assert values_of(found)["tension"] == 1.0
    assert evidence.left(found) < 0.2 * evidence.left(one)


def test_a_peak_that_is_wider_than_supposed_gets_its_speed() -> None:
    friction = {"torque_nm": 2.0, "stribeck_torque_nm": 1.5}
    problem = one_problem(use("coulomb_friction", **friction, stribeck_speed_rad_s=15.0))
    evidence, one = fitted(problem, use("coulomb_friction", **friction), "stribeck_torque_nm")
    values = values_of(refined(problem, evidence, one))
    assert values["stribeck_speed_rad_s"] == pytest.approx(15.0, rel=0.1)
    assert values["stribeck_torque_nm"] == pytest.approx(1.5, rel=0.1)


def test_numbers_that_the_data_do_not_tell_are_closed_again() -> None:
    told = use("coulomb_friction", torque_nm=2.0)
    problem = one_problem(told)
    evidence, one = fitted(problem, told, "offset_nm", "stribeck_torque_nm")
    found = refined(problem, evidence, one)
    assert found.hypothesis.open == ()
    assert values_of(found)["offset_nm"] == 0.0
    assert values_of(found)["torque_nm"] == pytest.approx(2.0, rel=0.02)
