"""The end of the first transient, and a request that turns back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from test_plans.conductor import PlannedSegment
from test_plans.metrics import (
    Arrival,
    NoValueError,
    Overshoot,
    Peak,
    ResponseTime,
    SettlingTime,
    Trough,
    transient_end_s,
)
from tests.test_plans.signals import STEP, recording_of, second_order_step, time_axis

TIME = time_axis()
SINCE = np.maximum(TIME - STEP.step_s, 0.0)
T: dict[str, Any] = {"channel": "shaft_torque_nm"}


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_slow_rise_is_over_when_less_than_the_band_is_left(sign: float) -> None:
    """exp(-t/τ) has fallen to 10 % of the step in half a second: from then the range is within ±5 %."""
    tau = 0.4
    segment = STEP.model_copy(update={"reference_after": sign * 326.0, "quantity": "driving_torque"})
    rise = sign * 326.0 * (1 - np.exp(-SINCE / tau))
    # The stretch's first and last sample are half a second less one sample time apart.
    wanted = 0.5 + tau * np.log((1 - np.exp(-0.499 / tau)) / 0.1)
    found = transient_end_s(recording_of(TIME, shaft_torque_nm=rise), segment) - STEP.step_s
    assert found == pytest.approx(wanted, abs=1.5e-3)


def test_a_window_that_ends_with_the_transient_leaves_a_late_resonance_out() -> None:
    step = second_order_step(TIME, 326.0, 0.2, 60.0)
    late = 300.0 * np.exp(-(((SINCE - 15.0) / 1.0) ** 2)) * np.sin(2 * np.pi * 9.0 * SINCE)
    recording = recording_of(TIME, shaft_torque_nm=step + late)
    first = Peak(**T, until="transient").compute(recording, STEP)
    assert first == pytest.approx(326.0 * (1 + np.exp(-np.pi * 0.2 / np.sqrt(1 - 0.04))), rel=1e-3)
    assert Peak(**T).compute(recording, STEP) > 600.0 > first
    assert "first transient" in Peak(**T, until="transient").definition


def test_a_window_without_a_transient_says_so() -> None:
    still = recording_of(TIME, shaft_torque_nm=0 * TIME + 10.0)
    with pytest.raises(NoValueError, match="no transient: shaft_torque_nm moves by less than 50 %"):
        Peak(**T, until="transient").compute(still, STEP)
    ringing = recording_of(TIME, shaft_torque_nm=326.0 * (1 + np.sin(30 * SINCE)))
    with pytest.raises(NoValueError, match="not over within the segment"):
        Peak(**T, until="transient").compute(ringing, STEP)


def test_a_segment_without_a_step_is_refused_when_it_is_planned() -> None:
    chirp = PlannedSegment("c", "chirp", 0.0, 0.0, 0.0, end_s=10.0)
    assert "has no step" in Peak(**T, until="transient").objection(chirp)
    assert Peak(**T).objection(chirp) == ""


def test_only_one_key_ends_the_window() -> None:
    with pytest.raises(ValidationError, match="both end the window"):
        Peak(**T, to_s=2.0, until="transient")


@pytest.mark.parametrize(
    "metric",
    [Peak(**T), Trough(**T), Overshoot(**T), ResponseTime(**T), Arrival(**T), SettlingTime(**T)],
    ids=lambda metric: metric.name,
)
def test_a_reversal_within_the_window_is_refused(metric) -> None:
    out = STEP.model_copy(
        update={"reference_before": 300.0, "reference_after": -150.0, "quantity": "driving_torque"}
    )
    asked = np.where(SINCE > 2.0, 300.0, np.where(STEP.step_s - 1e-6 <= TIME, -150.0, 300.0))
    torque = asked + 0.0
    with pytest.raises(
        NoValueError, match=r"reverses within the window, 2\S* s after .* from -150 to 300 N m"
    ):
        metric.compute(recording_of(TIME, shaft_torque_nm=torque, driving_torque_ref_nm=asked), out)


def test_a_request_that_goes_one_way_is_no_reversal() -> None:
    up = STEP.model_copy(update={"quantity": "driving_torque"})
    ramp = np.clip(SINCE * 1000.0, 0.0, 326.0)
    recording = recording_of(TIME, shaft_torque_nm=ramp, driving_torque_ref_nm=ramp)
    assert Peak(**T).compute(recording, up) == pytest.approx(326.0)
