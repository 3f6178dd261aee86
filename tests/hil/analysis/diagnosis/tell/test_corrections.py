"""Numbers of the base model that were a little off, and effects too small for a name."""

import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.search.search import begin_search
from hil.analysis.diagnosis.tell.corrections import (
    as_corrections,
    is_correction,
    started,
    suiting_a_gap,
    updates,
)
from hil.analysis.diagnosis.tell.result import NamedEffect
from hil.analysis.diagnosis.tell.words import Where
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

INERTIA = MODEL.parameters["motor_inertia"]


def test_a_number_that_noise_does_not_explain_is_told_as_it_was_and_is() -> None:
    problem = one_problem()
    found = begin_search(
        problem, fit(problem, Hypothesis(MODEL.with_parameters(motor_inertia=0.985 * INERTIA)))
    )
    told = updates(found, found.base, standard_errors(problem, found.base))
    old, new, error = told["motor_inertia"]
    assert old == pytest.approx(0.985 * INERTIA)
    assert abs(new - INERTIA) < 4.0 * error
    assert started(problem, found, found.base, standard_errors(problem, found.base), problem.floor) is None


@pytest.mark.parametrize(("by", "small"), [(1.01, True), (1.1, False)])
def test_within_its_tolerance_a_wrong_number_is_no_finding(by: float, small: bool) -> None:
    problem = one_problem()
    found = begin_search(problem, fit(problem, Hypothesis(MODEL)))
    wrong = EffectUse("parameter_mismatch", {"parameter": "motor_inertia", "value": by * INERTIA})
    assert is_correction(found, wrong, found.base) is small


def test_an_effect_too_small_for_a_name_is_a_correction_from_where_it_does_nothing() -> None:
    gain = EffectUse("sensor_gain", {"channel": OUTPUTS[2], "gain": 1.0004})
    effect = NamedEffect(gain, {"gain": 1e-4}, 0.9, Where((OUTPUTS[2],), (0.0, 1.0), "elsewhere"))
    assert as_corrections([effect]) == {f"sensor_gain.{OUTPUTS[2]}.gain": (1.0, 1.0004, 1e-4)}


def test_numbers_that_moved_beside_a_gap_are_said_to_suit_it() -> None:
    moved = {"motor_inertia": (0.02, 0.0196, 2e-5), "vehicle_inertia": (303.0, 298.1, 0.4)}
    (said,) = suiting_a_gap(moved, {OUTPUTS[0]: 5.4, OUTPUTS[2]: 10.4})
    assert said.startswith("motor_inertia, vehicle_inertia of the base model moved with 10.4 times its noise")
    assert OUTPUTS[2] in said
    assert "they suit what is missing as well" in said
    (of_one,) = suiting_a_gap({"motor_inertia": moved["motor_inertia"]}, {OUTPUTS[0]: 5.4})
    assert "it suits what is missing as well" in of_one
    assert of_one.endswith("than its standard error")
    assert suiting_a_gap(moved, {}) == suiting_a_gap({}, {OUTPUTS[0]: 5.4}) == []
