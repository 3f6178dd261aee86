"""Jerk against polynomials and sines, whose derivatives are known, through the filter as it is stated."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import signal

from test_plans.metrics import Jerk, NoValueError
from tests.test_plans.signals import SAMPLE_TIME_S, STEP, recording_of, time_axis

TIME = time_axis()
LATE = STEP.model_copy(update={"rolling_radius_m": 0.33})


def response(frequency_hz: float, corner_hz: float) -> float:
    """|H|² of a second-order Butterworth by Tustin's rule: forward and backward."""
    ratio = math.tan(math.pi * frequency_hz * SAMPLE_TIME_S) / math.tan(math.pi * corner_hz * SAMPLE_TIME_S)
    return 1 / (1 + ratio**4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_parabola_of_speed_has_one_jerk(sign: float) -> None:
    speed = 8.0 + sign * 7.0 * (TIME - 5.0) ** 2 / 2
    found = Jerk(from_s=5.0, to_s=15.0).compute(recording_of(TIME, vehicle_speed_m_s=speed), STEP)
    assert found == pytest.approx(7.0, rel=1e-9)


@pytest.mark.parametrize("frequency_hz", [5.0, 12.5, 25.0])
def test_a_sine_has_the_jerk_of_the_closed_form(frequency_hz: float) -> None:
    speed = 0.01 * np.cos(2 * np.pi * frequency_hz * (TIME - STEP.step_s))
    differences = (2 - 2 * math.cos(2 * math.pi * frequency_hz * SAMPLE_TIME_S)) / SAMPLE_TIME_S**2
    wanted = 0.01 * differences * response(frequency_hz, 25.0)
    metric = Jerk(from_s=5.0, to_s=15.0)
    assert metric.compute(recording_of(TIME, vehicle_speed_m_s=speed), STEP) == pytest.approx(
        wanted, rel=1e-9
    )


def test_the_wheel_force_over_the_mass_has_the_same_jerk() -> None:
    w = 2 * math.pi * 5.0
    torque = 300.0 * np.sin(w * (TIME - STEP.step_s))
    metric = Jerk(channel="shaft_torque_nm", mass_kg=2000.0, from_s=5.0, to_s=15.0)
    wanted = 300.0 / (0.33 * 2000.0) * math.sin(w * SAMPLE_TIME_S) / SAMPLE_TIME_S * response(5.0, 25.0)
    recording = recording_of(TIME, shaft_torque_nm=torque)
    assert metric.compute(recording, LATE) == pytest.approx(wanted, rel=1e-9)
    with pytest.raises(NoValueError, match="wheel's radius"):
        metric.compute(recording, STEP)


def test_a_coarse_speed_is_no_source_of_jerk() -> None:
    speed = 8.0 + 0.2 * np.maximum(TIME - STEP.step_s, 0.0)
    fine = recording_of(TIME, vehicle_speed_m_s=np.round(speed, 6))
    coarse = recording_of(TIME, vehicle_speed_m_s=np.round(speed, 2))
    assert Jerk().compute(fine, STEP) > 1.0
    with pytest.raises(NoValueError, match=r"steps of 0\.01 m/s.*shaft_torque_nm with 'mass_kg'"):
        Jerk().compute(coarse, STEP)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"channel": "motor_speed_rad_s"}, "comes from vehicle_speed_m_s or shaft_torque_nm"),
        ({"channel": "shaft_torque_nm"}, "needs 'mass_kg'"),
        ({"mass_kg": 2000.0}, "'mass_kg' belongs to"),
    ],
)
def test_what_gives_no_acceleration_is_refused(keys, words) -> None:
    with pytest.raises(ValidationError, match=words):
        Jerk(**keys)


def test_the_last_samples_of_a_segment_do_not_decide() -> None:
    """Beyond the segment another request acts, so that the filter has nothing to go on there."""
    speed = 8.0 + 0.2 * np.maximum(TIME - STEP.step_s, 0.0)
    known = Jerk().compute(recording_of(TIME, vehicle_speed_m_s=speed), STEP)
    bent = speed + 0.01 * (STEP.end_s - 4.5 * SAMPLE_TIME_S < TIME)  # 67 m/s³, were they to count
    assert Jerk().compute(recording_of(TIME, vehicle_speed_m_s=bent), STEP) == pytest.approx(known, rel=1e-6)


def test_the_definition_is_the_rule_and_not_two_central_differences() -> None:
    """By the definition's words alone: differences, the filter, differences."""
    time = time_axis()
    rng = np.random.default_rng(3)
    speed = np.cumsum(np.cumsum(rng.normal(size=len(time)))) * 1e-6
    words = Jerk().definition
    assert "differenced from sample to sample, low-pass filtered at 25 Hz" in words
    assert "(v[k+1] - 2 v[k] + v[k-1]) / T²" in words
    assert "central" not in words
    acceleration = signal.filtfilt(*signal.butter(2, 25.0, fs=1000.0), np.diff(speed) / 1e-3)
    by_hand = np.diff(acceleration) / 1e-3
    first, last = round(STEP.step_s / 1e-3) - 1, round((STEP.end_s - 1 / 25) / 1e-3) - 1
    found = Jerk().compute(recording_of(time, vehicle_speed_m_s=speed), STEP)
    assert found == pytest.approx(np.max(np.abs(by_hand[first : last + 1])), rel=1e-3)
