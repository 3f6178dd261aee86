"""Which base a search begins from: the given one while it leads anywhere, else the same identified."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.search.from_base import (
    _far_from_noise,
    _leads_elsewhere,
    _stated,
    is_far,
    moved,
    search_from_base,
)
from hil.analysis.diagnosis.search.race import Step
from hil.analysis.diagnosis.search.search import advanced, begin_search
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, left, one_problem

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
FAR = MODEL.with_parameters(
    **{name: MODEL.parameters[name] * f for name, f in (("motor_inertia", 1.5), ("shaft_stiffness", 0.6),
       ("wheel_inertia", 0.65), ("tyre_stiffness", 1.5), ("vehicle_inertia", 0.7), ("shaft_damping", 1.6))}
)  # fmt: skip


def silent(text: str) -> None:
    del text


def test_a_near_model_is_not_identified_anew() -> None:
    found = search_from_base(one_problem(OFFSET), Hypothesis(MODEL), silent)
    assert not found.best.hypothesis.far
    assert found.best.hypothesis.keys == (("sensor_offset", OUTPUTS[2]),)


def test_a_far_model_with_nothing_missing_gets_no_effect() -> None:
    found = search_from_base(one_problem(seconds=16.0), Hypothesis(FAR), silent)
    assert found.best.hypothesis.far
    assert found.best.hypothesis.keys == ()
    assert found.settled


@pytest.mark.parametrize(("beyond", "far"), [(1.0, False), (100.0, True)])
def test_numbers_come_before_care_where_what_wins_a_race_is_far_from_the_noise(
    beyond: float, far: bool
) -> None:
    problem = one_problem(OFFSET)
    near = begin_search(problem, fit(problem, Hypothesis(MODEL), rounds=0))
    winner = left(beyond * problem.rows, OFFSET)
    assert _far_from_noise(near, [Step(near.base, [], [winner])]) is far


@pytest.mark.slow
def test_an_effect_is_found_behind_far_numbers() -> None:
    friction = EffectUse("coulomb_friction", {"torque_nm": 3.0})
    found = search_from_base(one_problem(friction, seconds=16.0), Hypothesis(FAR), silent)
    assert found.best.hypothesis.far
    assert found.best.hypothesis.ids == ("coulomb_friction",)


def test_what_a_search_has_tried_is_not_tried_again_for_an_effect_that_explains_far_less() -> None:
    friction = EffectUse("coulomb_friction", {"torque_nm": 3.0})
    problem = one_problem(friction)
    found = begin_search(problem, fit(problem, Hypothesis(MODEL, far=True)))
    advanced(found, silent)
    assert found.best.hypothesis.ids == ("coulomb_friction",)
    assert _leads_elsewhere(found, [found.best])
    assert not _leads_elsewhere(found, [fit(problem, Hypothesis(MODEL, (OFFSET,)), rounds=0)])
    assert _leads_elsewhere(begin_search(problem, found.base), [])


def off(**by: float) -> Fit:
    """A fit whose parameters moved `by` logarithms, each known to a thousandth."""
    one = left(300.0)
    theta = one.theta.copy()
    names = [c.name for c in one.hypothesis.coordinates()]
    for name, value in by.items():
        theta[names.index(name)] = value
    return dataclasses.replace(one, theta=theta, covariance=1e-6 * np.eye(len(theta)))


def test_what_moved_is_more_than_its_tolerance_and_its_error() -> None:
    assert moved(off(shaft_stiffness=0.05, motor_inertia=0.015)) == ["shaft_stiffness"]
    unsure = dataclasses.replace(off(shaft_stiffness=0.05), covariance=np.full((9, 9), 0.04**2))
    assert moved(unsure) == []


def test_far_are_many_numbers_and_not_one() -> None:
    assert not is_far(off(shaft_stiffness=0.5, motor_inertia=0.5))
    assert is_far(off(shaft_stiffness=0.5, motor_inertia=0.5, wheel_inertia=0.4, vehicle_inertia=-0.3))


def test_dead_time_that_a_near_model_lacks_has_a_name_of_its_own() -> None:
    own = MODEL.parameters["torque_delay"]
    late, early = (
        _stated(off(torque_delay=by, gear_ratio=0.1), ["torque_delay", "gear_ratio"]) for by in (0.5, -0.5)
    )
    assert [use.id for use in late] == ["dead_time", "parameter_mismatch"]
    assert late[0].values["extra_delay_s"] == pytest.approx(own * (np.exp(0.5) - 1.0))
    assert [use.values.get("parameter") for use in early] == ["torque_delay", "gear_ratio"]
