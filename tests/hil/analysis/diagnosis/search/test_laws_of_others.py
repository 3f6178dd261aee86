"""Friction and contact by the laws of other authors: the form that data show, and no more numbers."""

import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.evidence import Evidence
from hil.analysis.diagnosis.search.forms import by_other_laws
from hil.analysis.diagnosis.search.optional import refined
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


@pytest.mark.parametrize(
    "law", [{"contact_damping_nms_rad": 40.0}, {"depth_damping_nms_rad2": 1500.0}], ids=["speed", "depth"]
)
def test_flanks_that_pull_are_found_from_flanks_that_do_not(law: dict[str, float]) -> None:
    problem = one_problem(use("backlash", half_gap_rad=0.01, tension=1.0, **law))
    evidence, one = fitted(problem, use("backlash", half_gap_rad=0.01))
    assert not evidence.closed(one)
    found = by_other_laws(evidence, one)
    values = values_of(found)
    assert (values["tension"], evidence.closed(found)) == (1.0, True)
    assert values["half_gap_rad"] == pytest.approx(0.01, rel=0.01)
    for name, value in law.items():
        assert values[name] == pytest.approx(value, rel=0.1)


def test_damping_that_sets_in_over_a_depth_is_found() -> None:
    law = {"half_gap_rad": 0.01, "contact_damping_nms_rad": 30.0, "contact_depth_rad": 2e-3}
    problem = one_problem(use("backlash", **law))
    evidence, one = fitted(problem, use("backlash", half_gap_rad=0.01))
    found = refined(problem, evidence, one)
    assert evidence.closed(found)
    values = values_of(found)
    assert values["half_gap_rad"] == pytest.approx(0.01, rel=0.02)
    assert values["contact_damping_nms_rad"] == pytest.approx(30.0, rel=0.1)


def test_dissipation_that_begins_with_the_force_is_found() -> None:
    problem = one_problem(use("backlash", half_gap_rad=0.01, contact_depth_rad=1e-3, one_spring=1.0))
    evidence, one = fitted(problem, use("backlash", half_gap_rad=0.01))
    assert not evidence.closed(one)
    found = by_other_laws(evidence, one)
    values = values_of(found)
    assert (values["one_spring"], evidence.closed(found)) == (1.0, True)
    assert values["half_gap_rad"] == pytest.approx(0.01, rel=0.02)
    assert 1e-4 < values["contact_depth_rad"] < 3e-3  # it is passed within a sample or two


def test_a_depth_means_nothing_without_the_damping_that_it_is_of() -> None:
    told = use("backlash", half_gap_rad=0.01)
    problem = one_problem(told)
    damped = use("backlash", half_gap_rad=0.01, contact_damping_nms_rad=1e-3, contact_depth_rad=5e-4)
    evidence, one = fitted(problem, damped, "contact_damping_nms_rad", "contact_depth_rad")
    found = refined(problem, evidence, one)
    assert found.hypothesis.open == ()
    assert values_of(found)["contact_depth_rad"] == 0.0


def test_an_effect_whose_own_law_leaves_noise_alone_is_tried_by_no_other() -> None:
    told = use("backlash", half_gap_rad=0.01)
    problem = one_problem(told)
    evidence, one = fitted(problem, told)
    assert by_other_laws(evidence, one) is one


def test_an_effect_without_other_laws_is_left_as_it_is() -> None:
    problem = one_problem(use("viscous_drag", coefficient_nms_rad=0.3))
    evidence, one = fitted(problem, use("viscous_drag", coefficient_nms_rad=0.1))
    assert by_other_laws(evidence, one) is one
