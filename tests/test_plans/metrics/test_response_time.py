"""Response time and arrival against a first-order response, whose crossings are known."""

from __future__ import annotations

import numpy as np
import pytest

from test_plans.metrics import (
    ArrivalShaftTorque,
    NotReachedError,
    NoValueError,
    ResponseTimeShaftTorque,
)
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
TIME_CONSTANT_S = 0.25
DOWN = STEP.model_copy(update={"reference_before": 200.0, "reference_after": -100.0})


def first_order(before: float, after: float) -> np.ndarray:
    t = np.maximum(TIME - STEP.step_s, 0.0)
    return after + (before - after) * np.exp(-t / TIME_CONSTANT_S)


@pytest.mark.parametrize("share", [10.0, 50.0, 90.0])
@pytest.mark.parametrize(("segment", "values"), [(STEP, (0.0, 326.0)), (DOWN, (200.0, -100.0))])
def test_the_first_crossing_is_that_of_the_closed_form(share, segment, values) -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(*values))
    found = ResponseTimeShaftTorque(share_percent=share).compute(recording, segment)
    assert found == pytest.approx(-TIME_CONSTANT_S * np.log(1 - share / 100), abs=2e-6)


def test_what_never_gets_there_says_how_far_it_got() -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(0.0, 178.0))
    with pytest.raises(NotReachedError, match=r"at most 54\.6 % within 20 s"):
        ResponseTimeShaftTorque().compute(recording, STEP)


@pytest.mark.parametrize(("after", "percent"), [(326.0, 0.0), (178.0, -45.399), (400.0, 22.699)])
def test_arrival_is_the_distance_of_the_last_mean(after: float, percent: float) -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(0.0, after))
    assert ArrivalShaftTorque().compute(recording, STEP) == pytest.approx(percent, abs=1e-3)


def test_a_step_down_that_goes_too_far_has_arrived_beyond() -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(200.0, -160.0))
    assert ArrivalShaftTorque().compute(recording, DOWN) == pytest.approx(20.0, abs=1e-6)


def test_without_a_step_there_is_nothing_to_follow() -> None:
    level = STEP.model_copy(update={"reference_before": 326.0})
    recording = recording_of(TIME, shaft_torque_nm=first_order(0.0, 326.0))
    for metric in (ResponseTimeShaftTorque(), ArrivalShaftTorque()):
        with pytest.raises(NoValueError, match="no step"):
            metric.compute(recording, level)
