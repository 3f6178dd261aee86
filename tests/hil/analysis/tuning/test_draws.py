"""Cars around a model: within their tolerances, the same for the same seed."""

import dataclasses
import math

import numpy as np
import pytest

from hil.analysis.tuning import draws_of, free_from_toml
from hil.core.errors import BadInputError
from tests.hil.analysis.tuning.trials import FREE, MODEL

TOLERANCE = free_from_toml(FREE, "f").tolerance


def test_the_first_is_the_model_itself_without_noise():
    first, *others = draws_of(MODEL, TOLERANCE, 5, 3)
    assert (first.model, first.noise, dict(first.differs)) == (MODEL, 0.0, {})
    assert [draw.number for draw in others] == [1, 2, 3, 4, 5]
    assert {draw.noise for draw in others} == {1.0}


def test_all_lie_within_the_tolerances_and_fill_them():
    draws = draws_of(MODEL, TOLERANCE, 64, 3)[1:]
    inertia = np.array([d.model.parameters["vehicle_inertia"] for d in draws]) / 303.0 - 1
    delay = np.array([d.model.parameters["torque_delay"] for d in draws]) - 0.008
    gap = np.array([d.differs["backlash.half_gap_rad"] for d in draws])
    phase = np.array([d.differs["wheel_order_disturbance.phase_rad"] for d in draws])
    for values, low, high in (
        (inertia, -0.1, 0.1),
        (delay, -0.001, 0.001),
        (gap, 0.0, 0.01),
        (phase, 0.0, 2 * math.pi),
    ):
        assert low <= values.min() < low + 0.05 * (high - low)
        assert high >= values.max() > high - 0.05 * (high - low)


def test_the_same_seed_gives_the_same_cars_and_fewer_are_the_first_of_more():
    assert draws_of(MODEL, TOLERANCE, 4, 7) == draws_of(MODEL, TOLERANCE, 4, 7)
    assert draws_of(MODEL, TOLERANCE, 4, 7) != draws_of(MODEL, TOLERANCE, 4, 8)


def test_standard_errors_of_an_identified_model_are_drawn_from():
    nothing = free_from_toml("[free]\nlead_deg = [0, 1]\n", "f").tolerance
    known = dataclasses.replace(MODEL, meta={"standard_errors": {"shaft_stiffness": 60.0}})
    values = [d.model.parameters["shaft_stiffness"] for d in draws_of(known, nothing, 256, 0)[1:]]
    assert np.std(values) == pytest.approx(60.0, rel=0.1)
    assert draws_of(MODEL, nothing, 9, 0) == draws_of(MODEL, nothing, 0, 0)


def test_a_tolerance_of_a_parameter_that_the_model_has_not_is_refused():
    rigid = free_from_toml("[free]\nlead_deg = [0, 1]\n[tolerance]\nviscous_drag = 0.1\n", "f").tolerance
    with pytest.raises(BadInputError, match="has no such parameter"):
        draws_of(MODEL, rigid, 1, 0)
