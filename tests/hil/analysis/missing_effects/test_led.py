"""Where recorded speeds lead, numbers of what bends are found from far off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.core.model import EffectUse
from hil.plant import Led, ideal_sensors, pack, simulate_many
from tests.hil.analysis.missing_effects.chain import NUMBERS, chirp_problem

_OFF = {"motor_inertia": 0.85, "shaft_stiffness": 1.25}


@pytest.mark.parametrize(
    ("effect", "number", "value", "begun"),
    [
        ("backlash", "half_gap_rad", 0.01, 0.014),
        ("shaft_cubic_stiffness", "coefficient_nm_rad3", 3e6, 2e5),
    ],
)
def test_an_effect_is_found_from_numbers_that_are_far_off(effect, number, value, begun) -> None:
    problem = chirp_problem(1.0, EffectUse(effect, {number: value}))
    numbers = {name: size * _OFF.get(name, 1.0) for name, size in NUMBERS.items()}
    hypothesis = Hypothesis(problem.model, numbers).with_term(EffectUse(effect, {number: begun}))
    led = Candidates(problem).led(point_at(problem, hypothesis)).hypothesis
    assert float(led.terms[0].values[number]) == pytest.approx(value, rel=0.01)
    for name in _OFF:
        assert led.numbers[name] == pytest.approx(NUMBERS[name], rel=0.01)


def test_a_speed_comes_to_the_one_that_leads_it_by_its_share_at_every_sample() -> None:
    """Closed form: a rigid axle without torque; its speed is off by (1 - share)^k after k samples."""
    problem = chirp_problem(1.0)
    model = problem.model.with_parameters(shaft_damping=0.0)
    count, share = 40, 0.1
    leading = Led(np.column_stack([np.full(count, 9.0 * NUMBERS["gear_ratio"]), np.full(count, 9.0)]), share)
    at_rest = np.zeros((1, 3))
    shown = simulate_many(
        pack(model)[None], np.zeros(count), 1e-3, at_rest, ideal_sensors(1), before_nm=0.0, led=leading
    )
    expected = 9.0 * (1.0 - (1.0 - share) ** np.arange(count))
    assert shown[0, :, 1] == pytest.approx(expected, abs=1e-6 * math.fsum(expected))
    assert shown[0, :, 0] == pytest.approx(expected * NUMBERS["gear_ratio"], abs=1e-6 * math.fsum(expected))


def test_a_side_that_was_not_recorded_leads_nothing() -> None:
    problem = chirp_problem(1.0)
    torque, starts = np.full(50, 3.0), np.zeros((1, 3))
    plain, led = (
        simulate_many(pack(problem.model)[None], torque, 1e-3, starts, ideal_sensors(1), led=one)
        for one in (None, Led(np.full((50, 2), np.nan), 0.5))
    )
    assert led == pytest.approx(plain, rel=1e-9, abs=1e-9)
