"""A model from a catalogue: every number off by a third or more, found again."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.far import identified
from hil.analysis.diagnosis.fit.fit import fit
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

FACTORS = {
    "motor_inertia": 1.5,
    "shaft_stiffness": 0.6,
    "shaft_damping": 1.7,
    "wheel_inertia": 0.7,
    "tyre_stiffness": 1.4,
    "vehicle_inertia": 1.3,
    "torque_delay": 0.7,
}


def test_far_numbers_are_found_again() -> None:
    problem = one_problem(seconds=16.0)
    wrong = MODEL.with_parameters(**{n: MODEL.parameters[n] * f for n, f in FACTORS.items()})
    _, found = identified(problem, Hypothesis(wrong))
    assert found.cost == pytest.approx(problem.rows, rel=0.1)
    values = found.hypothesis.model(found.theta).parameters
    for name in ("motor_inertia", "shaft_stiffness", "torque_delay"):
        assert values[name] == pytest.approx(MODEL.parameters[name], rel=0.01), name


def test_what_recordings_do_not_tell_stays_as_it_was() -> None:
    problem = one_problem()
    silent = dataclasses.replace(problem, weights=tuple(w * [1.0, 0.0, 0.0] for w in problem.weights))
    wrong = MODEL.with_parameters(motor_inertia=0.035)
    known, found = identified(silent, Hypothesis(wrong))
    assert known.misfit >= 1.0
    values = found.hypothesis.model(found.theta).parameters
    assert values["gear_ratio"] == pytest.approx(MODEL.parameters["gear_ratio"], rel=0.1)


def test_a_tolerance_of_the_model_file_widens_a_near_fit() -> None:
    problem = one_problem()
    wrong = MODEL.with_parameters(shaft_stiffness=1.12 * MODEL.parameters["shaft_stiffness"])
    near = fit(problem, Hypothesis(wrong))
    told = dataclasses.replace(wrong, tolerance={"shaft_stiffness": 0.15})
    wide = fit(problem, Hypothesis(told))
    assert wide.cost < 0.7 * near.cost
    assert np.sqrt(wide.cost / problem.rows) < 1.1
