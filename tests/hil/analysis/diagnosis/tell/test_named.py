"""What is named, and what was looked at and is not."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.search.race import Step
from hil.analysis.diagnosis.search.search import search
from hil.analysis.diagnosis.search.thresholds import LEAST_EVIDENCE
from hil.analysis.diagnosis.tell.named import clean, considered, lasting, reduced
from hil.analysis.diagnosis.tell.result import NamedEffect
from hil.analysis.diagnosis.tell.words import Where
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def test_phases_lie_within_half_a_turn_and_what_was_not_fitted_is_left_out() -> None:
    ripple = EffectUse("motor_order_ripple", {"order": 8.0, "amplitude_nm": 1.0, "phase_rad": 7.0})
    assert clean(ripple).values["phase_rad"] == pytest.approx(7.0 - 2.0 * np.pi)
    friction = EffectUse("coulomb_friction", EFFECTS["coulomb_friction"].completed({"torque_nm": 2.0}))
    assert clean(friction).values == {"torque_nm": 2.0}


def test_a_model_file_keeps_effects_and_no_wrong_number() -> None:
    drag = EffectUse("viscous_drag", {"coefficient_nms_rad": 0.01})
    wrong = EffectUse("parameter_mismatch", {"parameter": "motor_inertia", "value": 0.02})
    assert lasting(MODEL.with_effects(drag, wrong)) == [drag]


def test_what_was_not_named_comes_with_its_reason() -> None:
    problem = one_problem(EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0}))
    found = search(problem, Hypothesis(MODEL), lambda text: None)
    rows = considered(problem, found, found.best)
    assert ("sensor_offset", OUTPUTS[2]) not in {(row.id, row.about) for row in rows}
    assert len(rows) > 3
    assert all(row.reason for row in rows)
    assert [row.score for row in rows] == sorted((row.score for row in rows), reverse=True)


def test_where_nothing_was_fitted_no_effect_is_held_against_a_best_one() -> None:
    problem = one_problem(EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0}))
    found = search(problem, Hypothesis(MODEL), lambda text: None)
    found.steps = [Step(step.parent, step.scores, []) for step in found.steps]
    rows = considered(problem, found, found.base)
    assert rows[0].score > LEAST_EVIDENCE
    assert rows[0].reason.startswith("promises too small a share of what is left")
    assert not any("than the best" in row.reason for row in rows)


@pytest.mark.parametrize(("torque", "says"), [(1e-4, True), (0.5, False)])
def test_friction_that_is_nothing_but_a_constant_torque_is_said_to_be_one(torque: float, says: bool) -> None:
    use = EffectUse("coulomb_friction", {"torque_nm": torque, "offset_nm": 0.8})
    everywhere = Where((OUTPUTS[0],), (0.0, 1.0), "at all operating conditions")
    one = NamedEffect(use, {"torque_nm": 1.6e-4, "offset_nm": 9.7e-5}, 0.99, everywhere)
    said = reduced([one])
    assert bool(said) is says
    assert all("torque_nm itself is nothing" in text and "offset_nm = 0.8 N m" in text for text in said)


@pytest.mark.parametrize("id_", sorted(EFFECTS))
def test_any_effect_may_be_asked_whether_it_is_nothing(id_: str) -> None:
    numbers = {p.name: p.lower for p in EFFECTS[id_].parameters}
    errors = dict.fromkeys(numbers, 1.0)
    everywhere = Where((OUTPUTS[0],), (0.0, 1.0), "at all operating conditions")
    said = reduced([NamedEffect(EffectUse(id_, {**numbers}), errors, 0.99, everywhere)])
    assert all(text.startswith(f"of {id_} the ") for text in said)
