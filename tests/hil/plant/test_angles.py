"""Angles that speeds turn through, against what NumPy integrates; ripples follow them in a replay."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.channels import INPUT, MOTOR_ANGLE, TIME, WHEEL_ANGLE
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import (
    SENSOR_TURNED,
    angle_at,
    as_read,
    by_angle,
    half_window,
    ideal_sensors,
    replay,
    sensor_response,
    simulate,
    speed_of,
    turned,
)

STEP_S = 1e-3


def test_angles_are_integrals_from_the_first_one() -> None:
    time = np.arange(2000) * STEP_S
    speeds = np.column_stack([50.0 + 10.0 * np.sin(time), 5.0 + np.sin(time)])
    shown = turned(speeds, STEP_S, 10.0, 0.3)
    for column, factor, speed in ((0, 1.0, speeds[:, 1]), (1, 10.0, speeds[:, 0])):
        assert shown[-1, column] - 0.3 * factor == pytest.approx(np.trapezoid(speed, dx=STEP_S))


@pytest.mark.parametrize("missing", [0, 1])
def test_a_speed_that_was_not_recorded_follows_from_the_other(missing: int) -> None:
    speeds = np.tile([50.0, 5.0], (100, 1))
    speeds[:, missing] = np.nan
    assert turned(speeds, STEP_S, 10.0)[-1] == pytest.approx([5.0 * 0.099, 50.0 * 0.099])


def test_a_ripple_keeps_its_phase_where_the_model_would_turn_away() -> None:
    """The model has a tenth too little drag: its own angle is turns ahead at the end, its ripple is not."""
    numbers = {
        "motor_inertia": 0.5,
        "gear_ratio": 1.0,
        "vehicle_inertia": 0.5,
        "viscous_drag": 0.5,
        "torque_delay": 0.0,
    }
    values = EFFECTS["motor_order_ripple"].completed({"order": 4.0, "amplitude_nm": 5.0, "phase_rad": 0.4})
    truth = Model("rigid", numbers, (EffectUse("motor_order_ripple", values),))
    torque = np.full(20_000, 10.0)
    shown = simulate(truth, torque, STEP_S)
    speed = shown["motor_speed_rad_s"]
    recording = Recording(
        {TIME: np.arange(0.0, len(torque)) * STEP_S, INPUT: torque, "motor_speed_rad_s": speed},
        Path("ripple.csv"),
    )
    wrong = truth.with_parameters(viscous_drag=0.45)
    ripple = replay(wrong, recording)["motor_speed_rad_s"]
    ends = slice(-2000, None)
    swing, own = (one[ends] - np.convolve(one, np.ones(79) / 79, "same")[ends] for one in (speed, ripple))
    assert np.corrcoef(swing[:-100], own[:-100])[0, 1] > 0.99


def _swinging(hz: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, an angle in rad, and its speed in rad/s by a closed form."""
    time = np.arange(2000, dtype=np.float64) * STEP_S
    phase = 2.0 * np.pi * hz * time
    return time, 3.0 * time + np.sin(phase), 3.0 + 2.0 * np.pi * hz * np.cos(phase)


@pytest.mark.parametrize("hz", [5.0, 40.0])
def test_a_models_speed_is_read_as_its_angle_is(hz: float) -> None:
    _, angle, speed = _swinging(hz)
    outputs = np.column_stack([speed, speed, speed])
    shown = as_read(outputs, np.array([True, False, False]), STEP_S)
    inside = slice(half_window(STEP_S) + 1, -half_window(STEP_S) - 1)
    error = (shown[:, 0] - speed_of(angle, STEP_S))[inside]
    assert np.max(np.abs(error)) < 1e-4 * np.max(np.abs(speed))
    assert np.array_equal(shown[:, 1:], outputs[:, 1:])


def test_at_both_ends_the_same_is_read_of_a_straight_angle() -> None:
    angle = 0.2 + 7.0 * np.arange(50, dtype=np.float64) * STEP_S
    assert speed_of(angle, STEP_S) == pytest.approx(np.full(50, 7.0))
    assert as_read(np.full((50, 3), 7.0), np.ones(3, dtype=bool), STEP_S) == pytest.approx(
        np.full((50, 3), 7.0)
    )


def test_the_response_of_such_a_reading_is_that_of_a_mean() -> None:
    hz = 60.0
    _, angle, speed = _swinging(hz)
    sensors = ideal_sensors(1)[0]
    sensors[0, SENSOR_TURNED] = 2 * half_window(STEP_S) * STEP_S
    gain = sensor_response(sensors, np.array([hz]))[0, 0]
    assert np.std(speed_of(angle, STEP_S)[50:-50]) / np.std(speed[50:-50]) == pytest.approx(
        abs(gain), rel=1e-3
    )


def test_an_angle_stands_for_a_speed_that_was_not_recorded() -> None:
    time, angle, speed = _swinging(2.0)
    channels = {TIME: time, INPUT: speed, MOTOR_ANGLE: angle, WHEEL_ANGLE: angle, "wheel_speed_rad_s": speed}
    assert by_angle(Recording(channels, Path("r.csv"))).tolist() == [True, False, False]


def test_an_angle_that_begins_again_with_every_turn_goes_on() -> None:
    time, angle, _ = _swinging(0.5)
    recording = Recording({TIME: time, INPUT: time, MOTOR_ANGLE: angle % (2.0 * np.pi)}, Path("r.csv"))
    assert angle_at(recording, MOTOR_ANGLE, time) == pytest.approx(angle)


def test_a_replay_gives_the_angle_from_its_first_reading() -> None:
    """A mass without losses under a constant torque: θ = θ_0 + ½ T/J t²."""
    names = ("motor_inertia", "gear_ratio", "vehicle_inertia", "viscous_drag", "torque_delay")
    numbers = dict(zip(names, (0.5, 1.0, 0.5, 0.0, 0.0), strict=True))
    time = np.arange(1000, dtype=np.float64) * STEP_S
    angle = 4.0 + 0.5 * 2.0 * time**2
    recording = Recording({TIME: time, INPUT: np.full(1000, 2.0), MOTOR_ANGLE: angle}, Path("r.csv"))
    shown = replay(Model("rigid", numbers), recording)
    assert shown[MOTOR_ANGLE] == pytest.approx(angle, abs=2e-4)


def test_a_wrapped_angle_that_turns_too_far_between_samples_is_refused() -> None:
    time = np.arange(500, dtype=np.float64) * 4e-3
    channels = {TIME: time, INPUT: time, MOTOR_ANGLE: (1000.0 * time) % (2.0 * np.pi)}
    recording = Recording(channels, Path("fast.csv"))
    with pytest.raises(BadInputError, match="which way"):
        angle_at(recording, MOTOR_ANGLE, time)
    recording.channels[MOTOR_ANGLE] = 1000.0 * time
    assert angle_at(recording, MOTOR_ANGLE, time)[-1] == 1000.0 * time[-1]
