"""Stability: cycles are found with their amplitude, orders and what decays are not."""

from __future__ import annotations

import numpy as np
import pytest

from test_plans import Array
from test_plans.metrics import StabilityOscillation, StabilityTorqueRequest, instability
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
AFTER = np.maximum(TIME - STEP.step_s, 0.0)
SPEED = 17.0 + 1.07 * AFTER  # rad/s, as under 326 N m
ANGLE = np.cumsum(SPEED) * 0.001
METRIC = StabilityOscillation(channel="shaft_torque_nm")
LIMITED = STEP.model_copy(update={"torque_limit_nm": 150.0})


def line_of(torque: Array, speed: Array = SPEED, metric: StabilityOscillation = METRIC):
    return metric.line(recording_of(TIME, shaft_torque_nm=torque, wheel_speed_rad_s=speed), STEP)


@pytest.mark.parametrize("frequency", [3.4, 10.6, 44.7, 120.0])
@pytest.mark.parametrize("amplitude", [5.0, 60.0])
def test_a_cycle_is_found_with_its_amplitude(frequency: float, amplitude: float) -> None:
    found = line_of(326.0 + amplitude * np.sin(2 * np.pi * frequency * TIME))
    assert found.amplitude == pytest.approx(amplitude, rel=0.03)
    assert found.frequency_hz == pytest.approx(frequency, abs=0.3)


@pytest.mark.parametrize("order", [1.0, 3.0, 3.68, 24.0])
def test_an_order_of_the_wheel_is_none(order: float) -> None:
    assert line_of(326.0 + 105.0 * np.sin(order * ANGLE)).amplitude < 3.0


def test_a_cycle_under_a_stronger_order_is_found() -> None:
    torque = 326.0 + 105.0 * np.sin(3 * ANGLE) + 40.0 * np.sin(2 * np.pi * 44.7 * TIME)
    found = line_of(torque)
    assert found.amplitude == pytest.approx(40.0, rel=0.05)
    assert found.frequency_hz == pytest.approx(44.7, abs=0.3)


def test_what_decays_does_not_count_and_what_grows_does() -> None:
    ringing = np.sin(2 * np.pi * 10.6 * TIME)
    assert line_of(326.0 + 100.0 * np.exp(-AFTER / 5.0) * ringing).amplitude < 3.0
    grown = line_of(326.0 + np.exp(0.2 * AFTER) * ringing)
    assert grown.amplitude == pytest.approx(np.exp(0.2 * 19.4), rel=0.05)


@pytest.mark.parametrize(
    ("torque", "found"),
    [
        (30.0 * np.sin(3 * 17.0 * TIME), 0.0),
        (30.0 * np.sin(2 * np.pi * 45.0 * TIME), 30.0),
        (np.exp(0.2 * AFTER) * np.sin(3 * 17.0 * TIME), float(np.exp(0.2 * 19.5))),
    ],
    ids=["low and steady", "high", "grows"],
)
def test_at_constant_speed_what_is_high_or_grows_counts(torque: Array, found: float) -> None:
    speed = np.full(len(TIME), 17.0)
    assert line_of(326.0 + torque, speed).amplitude == pytest.approx(found, rel=0.1, abs=1.0)


@pytest.mark.parametrize("after_s", [2.0, 4.0, 8.0])
def test_an_order_is_no_cycle_in_short_segments_either(after_s: float) -> None:
    short = STEP.model_copy(update={"end_s": STEP.step_s + after_s})
    for torque in (30.0 * np.sin(3 * ANGLE), 60.0 * np.sin(3.68 * ANGLE)):
        recording = recording_of(TIME, shaft_torque_nm=326.0 + torque, wheel_speed_rad_s=SPEED)
        assert METRIC.line(recording, short).amplitude < 6.0


@pytest.mark.parametrize(
    ("request_nm", "share"),
    [
        (np.full(len(TIME), 40.0), 0.0),
        (np.full(len(TIME), 150.0), 1.0),
        (150.0 * np.sign(np.sin(2 * np.pi * 45 * TIME)), 1.0),
        (40.0 - 80.0 * (np.sin(2 * np.pi * 45 * TIME) > 0), 0.5),
        (40.0 + 10.0 * np.sin(2 * np.pi * 45 * TIME), 0.0),
        (np.where(AFTER < 5.0, 150.0, 40.0), 0.0),  # a stable loop may lie at its limit at first
    ],
    ids=["steady", "at its limit", "bangs", "against what was asked", "ripples", "at first"],
)
def test_a_request_at_its_limit_or_against_what_was_asked_counts(request_nm: Array, share: float) -> None:
    recording = recording_of(TIME, motor_torque_ref_nm=request_nm)
    assert StabilityTorqueRequest().compute(recording, LIMITED) == pytest.approx(share, abs=0.02)


def test_a_loop_that_grew_until_it_was_stopped_is_told_from_a_single_peak() -> None:
    stopped = LIMITED.model_copy(update={"end_s": 5.0, "complete": False})
    request = np.full(len(TIME), 40.0)
    growing = 326.0 + np.exp(2.5 * AFTER) * np.sin(2 * np.pi * 20.0 * TIME)
    peak = 326.0 * (1 - np.exp(-AFTER / 0.1)) + 300.0 * np.exp(-(((AFTER - 1.8) / 0.1) ** 2))
    found = {
        name: instability(recording_of(TIME, shaft_torque_nm=torque, motor_torque_ref_nm=request), stopped)
        for name, torque in (("growing", growing), ("peak", peak))
    }
    assert "oscillates at 20 Hz" in found["growing"]
    assert found["peak"] == ""
