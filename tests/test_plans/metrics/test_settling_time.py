from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from test_plans import Array
from test_plans.conductor import PlannedSegment
from test_plans.metrics import (
    DidNotSettleError,
    NoValueError,
    Ripple,
    SettlingShaftTorque,
    SettlingTime,
    SettlingToReference,
)
from test_plans.metrics._low_pass import low_passed
from tests.test_plans.signals import STEP, recording_of, second_order_step, time_axis


@given(st.floats(0.2, 10.0))
def test_a_first_order_response_settles_after_three_time_constants(rate: float) -> None:
    time = time_axis()
    torque = 326 * -np.expm1(-rate * np.maximum(time - STEP.step_s, 0))
    # Around its mean over the last 2 s, which a slow response has not reached.
    final = 326 * (1 - np.exp(-20 * rate) * (np.exp(2 * rate) - 1) / (2 * rate))
    expected = -np.log((326 - final + 0.05 * 326) / 326) / rate
    settling = SettlingShaftTorque().compute(recording_of(time, shaft_torque_nm=torque), STEP)
    # The low-pass at 50 Hz rounds the corner at the step, and moves the crossing by a few samples.
    assert settling == pytest.approx(expected, abs=0.003)


def test_a_second_order_response_settles_at_its_last_crossing() -> None:
    damping, frequency = 0.1, 2 * np.pi
    time = time_axis(sample_time_s=0.0005)
    torque = second_order_step(time, 326.0, damping, frequency)
    outside = np.abs(torque - 326) > 0.05 * 326
    expected = time[np.flatnonzero(outside)[-1]] - STEP.step_s
    # The envelope exp(-ζωt) bounds it.
    assert expected <= -np.log(0.05 * np.sqrt(1 - damping**2)) / (damping * frequency)
    settling = SettlingShaftTorque().compute(recording_of(time, shaft_torque_nm=torque), STEP)
    assert settling == pytest.approx(expected, abs=0.005)


def test_ripple_above_the_corner_frequency_is_filtered_out() -> None:
    time = time_axis()
    torque = 326.0 * (time >= STEP.step_s) + 40 * np.sin(2 * np.pi * 250 * time)
    assert SettlingShaftTorque().compute(recording_of(time, shaft_torque_nm=torque), STEP) < 0.05


def test_what_moves_to_the_end_has_no_settling_time() -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=326 + 40 * np.sin(2 * np.pi * 8 * time))
    with pytest.raises(
        DidNotSettleError, match=r"never settled: .* at (19\.9\d|20) s after the step; the window ends at 20"
    ):
        SettlingShaftTorque().compute(recording, STEP)
    assert SettlingTime(channel="shaft_torque_nm", band_percent=20).compute(recording, STEP) == 0.0


@pytest.mark.parametrize(("last_s", "settles"), [(17.9, True), (18.1, False)])
def test_settling_ends_where_the_mean_begins(last_s: float, settles: bool) -> None:
    time = time_axis()
    torque = np.where(time < STEP.step_s + last_s, 0.0, 326.0)
    recording = recording_of(time, shaft_torque_nm=torque)
    if settles:
        assert SettlingShaftTorque().compute(recording, STEP) == pytest.approx(last_s, abs=0.02)
    else:
        with pytest.raises(DidNotSettleError):
            SettlingShaftTorque().compute(recording, STEP)


def test_a_response_that_is_there_at_once() -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=np.full(len(time), 326.0))
    assert SettlingShaftTorque().compute(recording, STEP) == 0.0


def test_no_value() -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=np.zeros(len(time)))
    with pytest.raises(NoValueError, match="the mean alone takes 2 s"):
        SettlingShaftTorque().compute(recording, STEP.model_copy(update={"end_s": 4.5}))
    with pytest.raises(NoValueError, match="no step"):
        SettlingShaftTorque().compute(recording, STEP.model_copy(update={"reference_before": 326.0}))
    slow = time_axis(sample_time_s=0.01)
    with pytest.raises(NoValueError, match="needs more than 100 samples"):
        SettlingShaftTorque().compute(recording_of(slow, shaft_torque_nm=np.zeros(len(slow))), STEP)


@pytest.mark.parametrize("samples", [2, 10, 501])
@pytest.mark.parametrize("corner_hz", [3.0, 50.0, 400.0])
def test_the_low_pass_is_that_of_scipy(samples: int, corner_hz: float) -> None:
    values = np.cumsum(np.random.default_rng(1).normal(size=samples))
    padding = min(samples - 1, int(np.ceil(1000 / corner_hz)))
    sections = signal.butter(2, corner_hz, fs=1000, output="sos")
    expected = signal.sosfiltfilt(sections, values, padlen=padding)
    assert low_passed(values, corner_hz, 0.001) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def ramp(length_s: float) -> Array:
    """From 0 to 326 N m within `length_s` after the step: the filter leaves a straight line alone."""
    return 326 * np.clip((time_axis() - STEP.step_s) / length_s, 0.0, 1.0)


def settled(torque: Array, **options: float | None) -> float:
    given: dict[str, Any] = {"channel": "shaft_torque_nm"} | options
    metric = SettlingTime(**given)
    return metric.compute(recording_of(time_axis(), shaft_torque_nm=torque), STEP)


@pytest.mark.parametrize(("band_percent", "expected"), [(5.004, 9.5), (5.006, 9.5), (5.014, 9.499)])
def test_the_first_sample_within_the_band_counts(band_percent: float, expected: float) -> None:
    # leaves the band at 10 s less its half width: 9.4996, 9.4994 and 9.4986 s
    assert settled(ramp(10.0), band_percent=band_percent) == pytest.approx(expected, abs=1e-6)


def test_what_was_settled_before_the_window_begins_is_settled_at_its_begin() -> None:
    assert settled(ramp(3.0), from_s=5.0) == 5.0
    # outside at the window's first sample, inside at its second
    assert settled(ramp(10.0), from_s=9.499, band_percent=5.004) == pytest.approx(9.5, abs=1e-6)


def test_what_does_not_settle_says_until_when_it_moved() -> None:
    torque, after = ramp(1.7), time_axis() - STEP.step_s
    final = np.mean(torque[(after > 1.5) & (after <= 3.0)])
    last = after[np.flatnonzero(np.abs(torque - final) > 0.05 * 326)[-1]]
    assert 1.5 < last < 1.7
    said = f"at {last:.4g} s after the step; the window ends at 3 s"
    with pytest.raises(DidNotSettleError, match=said):
        settled(torque, to_s=3.0, mean_s=1.5)


def test_the_mean_needs_less_than_the_whole_window() -> None:
    level = np.full(len(time_axis()), 326.0)
    for to_s, mean_s in ((2.0, 2.0), (1.5, 2.0), (3.5, 4.0)):
        with pytest.raises(NoValueError, match=f"is {to_s:g} s long, the mean alone takes {mean_s:g} s"):
            settled(level, to_s=to_s, mean_s=mean_s)
    assert settled(level, to_s=2.001) == 0.0


@pytest.mark.parametrize("mean_s", [0.001, 0.0005, 1e-9])
def test_a_mean_without_samples_is_no_value(mean_s: float) -> None:
    time = time_axis(22.999)  # a segment's last sample lies one sample time before its end
    recording = recording_of(time, shaft_torque_nm=10.0 * time)
    metric = SettlingTime(channel="shaft_torque_nm", mean_s=mean_s)
    with pytest.raises(NoValueError, match="hold no sample, these lie 0.001 s apart"):
        metric.compute(recording, STEP)


def test_what_is_outside_at_the_very_last_sample_did_not_settle() -> None:
    torque = np.where(time_axis() < STEP.end_s - 1.2, 326.0, 0.0)
    torque[time_axis() >= STEP.end_s - 0.6] = 326.0  # the mean lies half way: all of it is outside
    with pytest.raises(DidNotSettleError, match="at 20 s after the step; the window ends at 20 s"):
        settled(torque, mean_s=1.2)


def test_the_filter_needs_more_than_two_samples_a_period() -> None:
    for rate_hz, refused in ((120, False), (100, True)):
        time = time_axis(sample_time_s=1 / rate_hz)
        recording = recording_of(time, shaft_torque_nm=np.full(len(time), 326.0))
        if refused:
            with pytest.raises(NoValueError, match=f"the recording has {rate_hz:g}$"):
                SettlingShaftTorque().compute(recording, STEP)
        else:
            assert SettlingShaftTorque().compute(recording, STEP) == 0.0


@pytest.mark.parametrize(
    ("end_s", "options", "said"),
    [
        (5.0, {}, ""),
        (2.9, {}, "the window is 1.9 s long, the mean alone takes 2 s"),
        (3.0, {}, "the window is 2 s long, the mean alone takes 2 s"),
        (9.0, {"from_s": 7.0}, "the window is 1 s long, the mean alone takes 2 s"),
        (9.0, {"to_s": 1.5}, "the window is 1.5 s long, the mean alone takes 2 s"),
        (9.0, {"to_s": 8.5}, "the window reaches to 8.5 s after the step, the segment to 8 s"),
        (9.0, {"to_s": 8.0}, ""),
    ],
)
def test_a_plan_hears_before_the_run_that_the_window_is_too_short(
    end_s: float, options: dict[str, float], said: str
) -> None:
    planned = PlannedSegment("up", "step", 1.0, 0.0, 326.0, end_s=end_s)
    given: dict[str, Any] = {"channel": "shaft_torque_nm"} | options
    metric = SettlingTime(**given)
    assert metric.objection(planned) == said


def test_a_step_is_one_that_changes_the_torque_by_value() -> None:
    same = PlannedSegment("hold", "hold", 1.0, 326.0, float("326"), end_s=20.0)
    assert "has no step" in SettlingShaftTorque().objection(same)


def test_the_definition_tells_band_mean_and_filter() -> None:
    assert SettlingShaftTorque().definition == (
        "Time from the step after which shaft_torque_nm (T_s) stays within ±5 % of the step's size around "
        "its mean over the last 2 s, from the step until the end of the segment. The channel is low-pass "
        "filtered at 50 Hz (Butterworth, order 2, forward and backward). Outside during the last 2 s: did "
        "not settle."
    )
    assert "within ±5 % of 80 around" in SettlingTime(channel="shaft_torque_nm", step_size=80.0).definition


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("misses", "settles"), [(0.04, True), (0.06, False)])
def test_what_rests_beside_the_reference_has_settled_but_not_there(sign, misses, settles) -> None:
    segment = STEP.model_copy(update={"reference_after": sign * 326.0})
    time = time_axis()
    torque = sign * 326 * (1 - misses) * -np.expm1(-5.0 * np.maximum(time - STEP.step_s, 0))
    recording = recording_of(time, shaft_torque_nm=torque)
    assert SettlingShaftTorque().compute(recording, segment) < 1.0
    metric = SettlingToReference(channel="shaft_torque_nm")
    if settles:
        expected = -np.log((0.05 - misses) / (1 - misses)) / 5.0
        assert metric.compute(recording, segment) == pytest.approx(expected, abs=0.003)
    else:
        with pytest.raises(DidNotSettleError, match="around the reference at"):
            metric.compute(recording, segment)


def test_an_order_of_the_wheel_is_ripple_and_keeps_nothing_from_settling() -> None:
    time = time_axis()
    wheel = 16.0 + 0.4 * time
    angle = 16.0 * time + 0.2 * time**2
    rise = 326 * -np.expm1(-5.0 * np.maximum(time - STEP.step_s, 0))
    recording = recording_of(time, shaft_torque_nm=rise + 40.0 * np.sin(3 * angle), wheel_speed_rad_s=wheel)
    declared = STEP.model_copy(update={"wheel_orders": (3.0,)})
    metric = SettlingToReference(channel="shaft_torque_nm")
    # The step's own transient leaks into what is followed of the order, for a moment.
    assert metric.compute(recording, declared) == pytest.approx(np.log(20) / 5.0, abs=0.15)
    with pytest.raises(DidNotSettleError):
        metric.compute(recording, STEP)
    assert Ripple(channel="shaft_torque_nm").compute(recording, declared) == pytest.approx(40.0, rel=1e-4)


def test_a_ripple_has_the_amplitude_of_its_sine() -> None:
    time = time_axis()
    torque = 300.0 + 25.0 * np.cos(2 * np.pi * 10.0 * (time - 22.0))
    recording = recording_of(time, shaft_torque_nm=torque)
    assert Ripple(channel="shaft_torque_nm").compute(recording, STEP) == pytest.approx(25.0, rel=1e-9)
