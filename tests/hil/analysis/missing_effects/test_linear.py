"""Numbers and linear effects of a chain by its responses, from far bases."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._linear import numbers_alone, responses_of, with_linear_effects
from hil.analysis.missing_effects._problem import Problem, problem_of
from hil.analysis.missing_effects._series import series_of
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from tests.hil.analysis.missing_effects.chain import MOTORS, NUMBERS, chirp_problem, multisine_problem


def numbers_of(problem: Problem) -> Hypothesis:
    responses = responses_of(problem)
    assert responses is not None
    return numbers_alone(responses)


def best_effect(problem: Problem) -> Hypothesis:
    responses = responses_of(problem)
    assert responses is not None
    return with_linear_effects(responses, numbers_alone(responses))[0][0]


@pytest.mark.parametrize("factor", [1.0, 0.4, 2.5])
def test_numbers_of_a_chain_come_out_the_same_from_any_base(factor: float) -> None:
    found = numbers_of(chirp_problem(factor)).numbers
    for name in ("motor_inertia", "shaft_stiffness", "vehicle_inertia"):
        assert found[name] == pytest.approx(NUMBERS[name], rel=0.02)


def test_torque_that_is_held_over_a_sample_is_no_dead_time() -> None:
    """Half a sample of 1 ms would be an eighth of the dead time."""
    found = numbers_of(chirp_problem(1.0)).numbers
    assert found["torque_delay"] == pytest.approx(NUMBERS["torque_delay"], rel=0.02)


def test_a_lag_behind_a_far_base_shows_in_the_responses() -> None:
    lag = EffectUse("actuator_lag", {"time_constant_s": 0.008})
    best = best_effect(chirp_problem(2.5, lag))
    assert best.names == ("actuator_lag",)
    assert float(best.terms[0].values["time_constant_s"]) == pytest.approx(0.008, rel=0.1)


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_a_base_that_is_off_as_a_whole_does_not_hold_its_numbers(factor: float) -> None:
    """Each number alone is likeliest where the base has it; with a drag beside it a lag bent the others."""
    lag = EffectUse("actuator_lag", {"time_constant_s": 0.0078})
    drag = EffectUse("load_viscous_drag", {"coefficient_nms_rad": 0.1})
    best = best_effect(multisine_problem(factor, lag, drag))
    assert best.names == ("actuator_lag",)
    assert float(best.terms[0].values["time_constant_s"]) == pytest.approx(0.0078, rel=0.12)
    for name in ("motor_inertia", "shaft_stiffness", "vehicle_inertia"):
        assert best.numbers[name] == pytest.approx(MOTORS[name], rel=0.12)


def test_a_rigid_model_has_no_responses_to_read() -> None:
    numbers = dict.fromkeys(("motor_inertia", "gear_ratio", "vehicle_inertia", "viscous_drag"), 1.0)
    model = Model("rigid", numbers | {"torque_delay": 0.0})
    time = np.arange(2000) * 1e-3
    shown = {"time_s": time, "motor_torque_ref_nm": np.sin(time), "motor_speed_rad_s": time}
    series = series_of(model, [Recording(shown, Path("rigid.csv"))])
    assert responses_of(problem_of(model, series, np.ones(3))) is None
