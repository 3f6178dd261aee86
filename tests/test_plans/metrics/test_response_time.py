"""Response time and arrival against a first-order response, whose crossings are known."""

from __future__ import annotations

import numpy as np
import pytest

from test_plans.conductor import PlannedSegment
from test_plans.metrics import (
    ArrivalShaftTorque,
    Delay,
    NotReachedError,
    NoValueError,
    OvershootPercentShaftTorque,
    PeakShaftTorque,
    ResponseTimeShaftTorque,
    Ripple,
    TimeToTolerance,
    Trough,
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


def test_a_window_shorter_than_the_mean_has_no_arrival() -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(0.0, 326.0))
    short = ArrivalShaftTorque(to_s=0.3)
    with pytest.raises(NoValueError, match=r"window is 0\.3 s long, the mean alone takes 2 s: give 'mean_s'"):
        short.compute(recording, STEP)
    planned = PlannedSegment("up", "step", 1.0, 0.0, 326.0, end_s=5.0)
    assert "is 0.3 s long" in short.objection(planned)
    assert "is 1.5 s long" in Ripple(channel="shaft_torque_nm", to_s=1.5).objection(planned)
    for metric in (ArrivalShaftTorque(to_s=2.0), ArrivalShaftTorque(to_s=0.3, mean_s=0.3)):
        assert metric.objection(planned) == ""
        assert np.isfinite(metric.compute(recording, STEP))


def test_a_step_down_that_goes_too_far_has_arrived_beyond() -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(200.0, -160.0))
    assert ArrivalShaftTorque().compute(recording, DOWN) == pytest.approx(20.0, abs=1e-6)


def test_without_a_step_there_is_nothing_to_follow() -> None:
    level = STEP.model_copy(update={"reference_before": 326.0})
    recording = recording_of(TIME, shaft_torque_nm=first_order(0.0, 326.0))
    for metric in (ResponseTimeShaftTorque(), ArrivalShaftTorque()):
        with pytest.raises(NoValueError, match="no step"):
            metric.compute(recording, level)


@pytest.mark.parametrize(("before", "after"), [(0.0, 326.0), (300.0, -150.0)])
def test_a_ramp_after_a_dead_time_sets_in_when_the_dead_time_is_over(before: float, after: float) -> None:
    segment = STEP.model_copy(update={"reference_before": before, "reference_after": after})
    torque = np.interp(TIME - STEP.step_s, [0.0275, 0.1275], [before, after])
    recording = recording_of(TIME, shaft_torque_nm=torque)
    assert Delay(channel="shaft_torque_nm").compute(recording, segment) == pytest.approx(0.0275, abs=1e-9)
    for share in (10.0, 50.0, 90.0):
        found = ResponseTimeShaftTorque(share_percent=share).compute(recording, segment)
        assert found == pytest.approx(0.0275 + share / 1000, abs=1e-9)


@pytest.mark.parametrize(("before", "after"), [(0.0, 326.0), (300.0, -150.0)])
@pytest.mark.parametrize(("damping", "zero"), [(0.2, 0.0), (0.5, 0.0), (0.4, -0.02)])
def test_python_control_finds_the_same_in_both_directions(before, after, damping, zero) -> None:
    """`step_info` of a second-order system, with a zero in the right half plane that undershoots."""
    import control

    w = 40.0
    system = control.tf([zero, 1.0], [1 / w**2, 2 * damping / w, 1.0])
    since = np.arange(20_001) / 1000
    _, unit = control.step_response(system, since)
    known = control.step_info(unit, since, final_output=1.0)
    size = after - before
    torque = np.full(len(TIME), before)
    torque[3000 : 3000 + len(unit)] += size * unit
    torque[3000 + len(unit) :] = after
    segment = STEP.model_copy(update={"reference_before": before, "reference_after": after})
    recording = recording_of(TIME, shaft_torque_nm=torque)
    peak = PeakShaftTorque().compute(recording, segment)
    assert (peak - before) / size == pytest.approx(known["Peak"], rel=1e-9)
    overshoot = OvershootPercentShaftTorque().compute(recording, segment)
    assert overshoot == pytest.approx(known["Overshoot"], rel=1e-9)
    trough = Trough(channel="shaft_torque_nm").compute(recording, segment)
    assert (trough - before) / size == pytest.approx(
        -known["Undershoot"] / 100 if zero else unit[1], rel=1e-9, abs=1e-12
    )
    rise = [
        ResponseTimeShaftTorque(share_percent=share).compute(recording, segment) for share in (10.0, 90.0)
    ]
    assert rise[1] - rise[0] == pytest.approx(known["RiseTime"], abs=1.001e-3)  # it takes whole samples


@pytest.mark.parametrize(("before", "after", "rise_s"), [(25.0, 300.0, 0.06), (-150.0, 300.0, 3.0)])
def test_an_order_of_the_wheel_that_hides_the_delay_gives_none(before, after, rise_s) -> None:
    """A dead time of 8 ms, and 40 N m beside that are at a tenth of the step as it begins."""
    segment = STEP.model_copy(update={"reference_before": before, "reference_after": after})
    since = TIME - STEP.step_s
    torque = np.interp(since, [0.008, 0.008 + rise_s], [before, after])
    torque += 40 * np.sin(2 * np.pi * 8 * since + 0.6)
    with pytest.raises(NoValueError, match="ms before the step: .*orders of the wheel"):
        Delay(channel="shaft_torque_nm").compute(recording_of(TIME, shaft_torque_nm=torque), segment)


def test_a_delay_of_nothing_is_nothing() -> None:
    torque = np.interp(TIME - STEP.step_s, [0.0, 0.1], [0.0, 326.0])
    found = Delay(channel="shaft_torque_nm").compute(recording_of(TIME, shaft_torque_nm=torque), STEP)
    assert found == pytest.approx(0.0, abs=1e-12)


def test_a_torque_that_is_there_at_the_step_answers_nothing() -> None:
    """300 to 299 N m, with 40 N m of an order beside: at the step it is beyond both."""
    small = STEP.model_copy(update={"reference_before": 300.0, "reference_after": 299.0})
    since = TIME - STEP.step_s
    torque = np.where(since < 0, 300.0, 299.0) - 40 * np.cos(2 * np.pi * 8 * since)
    recording = recording_of(TIME, shaft_torque_nm=torque)
    for metric in (ResponseTimeShaftTorque(), Delay(channel="shaft_torque_nm")):
        with pytest.raises(NoValueError, match=r"259 N m as the window begins, beyond \d+ % of the step"):
            metric.compute(recording, small)
    check = TimeToTolerance(channel="shaft_torque_nm", share_percent=50.0)
    assert check.compute(recording, small) == 0.0


def test_what_is_reached_before_the_window_has_no_time_in_it() -> None:
    recording = recording_of(TIME, shaft_torque_nm=first_order(0.0, 326.0))
    with pytest.raises(NoValueError, match="as the window begins"):
        ResponseTimeShaftTorque(from_s=5.0).compute(recording, STEP)
