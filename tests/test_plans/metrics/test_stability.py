"""Stability: cycles are found with their amplitude, orders and what decays are not."""

from __future__ import annotations

import numpy as np
import pytest

from test_plans import Array
from test_plans.metrics import Holding, StabilityOscillation, StabilityTorqueRequest, instability
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
AFTER = np.maximum(TIME - STEP.step_s, 0.0)
SPEED = 17.0 + 1.07 * AFTER  # rad/s, as under 326 N m
ANGLE = np.cumsum(SPEED) * 0.001
METRIC = StabilityOscillation(channel="shaft_torque_nm")
LIMITED = STEP.model_copy(update={"torque_limit_nm": 150.0})


def line_of(torque: Array, speed: Array = SPEED, orders: tuple[float, ...] = ()):
    segment = STEP.model_copy(update={"wheel_orders": orders})
    return METRIC.line(recording_of(TIME, shaft_torque_nm=torque, wheel_speed_rad_s=speed), segment)


@pytest.mark.parametrize("frequency", [4.4, 10.6, 44.7, 120.0])
@pytest.mark.parametrize("amplitude", [5.0, 60.0])
def test_a_cycle_is_found_with_its_amplitude(frequency: float, amplitude: float) -> None:
    found = line_of(326.0 + amplitude * np.sin(2 * np.pi * frequency * TIME))
    assert found.amplitude == pytest.approx(amplitude, rel=0.03)
    assert found.frequency_hz == pytest.approx(frequency, abs=0.3)


@pytest.mark.parametrize("order", [1.0, 3.0, 3.68, 24.0])
def test_a_declared_order_of_the_wheel_is_none(order: float) -> None:
    assert line_of(326.0 + 105.0 * np.sin(order * ANGLE), orders=(order,)).amplitude < 3.0
    assert line_of(326.0 + 105.0 * np.sin(order * ANGLE)).amplitude == pytest.approx(105.0, rel=0.05)


def test_a_cycle_under_a_stronger_order_is_found() -> None:
    torque = 326.0 + 105.0 * np.sin(3 * ANGLE) + 40.0 * np.sin(2 * np.pi * 44.7 * TIME)
    found = line_of(torque, orders=(3.0,))
    assert found.amplitude == pytest.approx(40.0, rel=0.05)
    assert found.frequency_hz == pytest.approx(44.7, abs=0.3)


def test_what_decays_does_not_count_and_what_grows_does() -> None:
    ringing = np.sin(2 * np.pi * 10.6 * TIME)
    assert line_of(326.0 + 100.0 * np.exp(-AFTER / 5.0) * ringing).amplitude < 6.0
    grown = line_of(326.0 + np.exp(0.2 * AFTER) * ringing)
    assert grown.amplitude == pytest.approx(np.exp(0.2 * 19.5), rel=0.1)


def test_shaking_that_ends_just_before_the_end_lasts() -> None:
    torque = 326.0 + np.where(AFTER < 21.0, 60.0, 0.0) * np.sin(2 * np.pi * 12.0 * TIME)
    assert line_of(torque).amplitude == pytest.approx(60.0, rel=0.03)


@pytest.mark.parametrize(("after_s", "frequency"), [(4.0, 0.8), (4.0, 1.6), (8.0, 0.5), (2.0, 2.5)])
def test_slow_shaking_is_no_holding(after_s: float, frequency: float) -> None:
    short = STEP.model_copy(update={"end_s": STEP.step_s + after_s, "wheel_orders": (3.0,)})
    torque = 326.0 + 120.0 * np.sin(2 * np.pi * frequency * TIME)
    recording = recording_of(TIME, shaft_torque_nm=torque, wheel_speed_rad_s=SPEED)
    assert Holding(channel="shaft_torque_nm").compute(recording, short) > 25.0


def test_bursts_count_whole() -> None:
    on = ((AFTER > 13.0) & (AFTER < 14.0)) | ((AFTER > 17.0) & (AFTER < 18.0))
    bursts = np.where(on, np.sin(2 * np.pi * 6.0 * TIME), 0.0)
    found = line_of(326.0 + 60.0 * bursts)
    assert found.amplitude == pytest.approx(60.0, rel=0.05)


def test_an_order_that_the_motor_makes_counts() -> None:
    ripple = 60.0 * np.sin(3 * ANGLE)
    segment = STEP.model_copy(update={"wheel_orders": (3.0,), "gear_ratio": 8.148})
    for of_motor, found in ((ripple, 60.0), (-0.5 * ripple, 0.0), (0.0 * ripple, 0.0)):
        channels = {"shaft_torque_nm": 326.0 + ripple, "motor_torque_nm": (326.0 + of_motor) / 8.148}
        recording = recording_of(TIME, **channels, wheel_speed_rad_s=SPEED)
        assert METRIC.line(recording, segment).amplitude == pytest.approx(found, rel=0.05, abs=2.0)


def test_noise_is_no_line() -> None:
    noise = np.random.default_rng(3).normal(0.0, 10.0, len(TIME))
    assert line_of(326.0 + noise).amplitude < 4.0


def test_an_order_that_is_not_declared_is_named() -> None:
    recording = recording_of(
        TIME,
        shaft_torque_nm=326.0 + 60.0 * np.sin(3 * 17.0 * TIME),
        wheel_speed_rad_s=np.full(len(TIME), 17.0),
    )
    short = STEP.model_copy(update={"end_s": STEP.step_s + 4.0})
    assert "which is order 3 of the wheel" in METRIC.remark(recording, short)


@pytest.mark.parametrize("after_s", [1.0, 2.0, 4.0, 8.0])
def test_a_declared_order_is_no_cycle_in_short_segments_either(after_s: float) -> None:
    for order, size in ((3.0, 30.0), (3.68, 60.0)):
        short = STEP.model_copy(update={"end_s": STEP.step_s + after_s, "wheel_orders": (order,)})
        torque = 326.0 + size * np.sin(order * ANGLE)
        recording = recording_of(TIME, shaft_torque_nm=torque, wheel_speed_rad_s=SPEED)
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
    ids=["steady", "at its limit", "bangs", "opposite to the request", "ripples", "at first"],
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


def test_an_order_of_the_wheel_is_no_loop_that_grew_when_a_run_is_ended() -> None:
    """A person ended a run: the ripple of a joint was told as a loop that is not stable."""
    ended = LIMITED.model_copy(update={"end_s": STEP.step_s + 7.0, "complete": False, "wheel_orders": (3.0,)})
    torque = 326.0 + 60.0 * np.sin(3 * ANGLE)
    request = np.full(len(TIME), 40.0)
    channels = {"shaft_torque_nm": torque, "motor_torque_ref_nm": request, "wheel_speed_rad_s": SPEED}
    assert instability(recording_of(TIME, **channels), ended) == ""
    undeclared = ended.model_copy(update={"wheel_orders": ()})
    assert "does not decay" in instability(recording_of(TIME, **channels), undeclared)
