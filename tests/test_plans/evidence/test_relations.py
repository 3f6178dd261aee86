"""What the drive train demands of its channels: a dead, half or mirrored one contradicts its neighbours."""

from __future__ import annotations

import numpy as np
import pytest

from hil.core.recording import Recording
from test_plans import Array
from test_plans.evidence import PROOFS, objections
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
GEAR, RADIUS_M = 8.148, 0.33
SEGMENT = STEP.model_copy(update={"gear_ratio": GEAR, "rolling_radius_m": RADIUS_M})
DRIVEN = np.clip((TIME - STEP.step_s) / 0.2, 0.0, 1.0)


def axle(**changed: Array) -> Recording:
    """An axle that accelerates under 326 N m, every sensor with its noise; some channels changed."""
    draws = np.random.default_rng(5)

    def noisy(values: Array, size: float) -> Array:
        return np.asarray(values + draws.normal(0.0, size, len(TIME)))

    wheel = 2.0 + np.cumsum(DRIVEN) * 1.07e-3
    channels = {
        "motor_torque_ref_nm": 40.5 * DRIVEN,
        "motor_torque_nm": 40.5 * DRIVEN,
        "motor_speed_rad_s": noisy(GEAR * wheel, 0.02),
        "wheel_speed_left_rad_s": noisy(wheel, 0.002),
        "wheel_speed_right_rad_s": noisy(wheel, 0.002),
        "shaft_torque_left_nm": noisy(163.0 * DRIVEN, 0.5),
        "shaft_torque_right_nm": noisy(163.0 * DRIVEN, 0.5),
        "vehicle_speed_m_s": RADIUS_M * wheel,
    } | changed
    left, right = channels["shaft_torque_left_nm"], channels["shaft_torque_right_nm"]
    speeds = channels["wheel_speed_left_rad_s"] + channels["wheel_speed_right_rad_s"]
    return recording_of(TIME, **channels, shaft_torque_nm=left + right, wheel_speed_rad_s=0.5 * speeds)


def test_a_sound_axle_has_nothing_to_object_to() -> None:
    assert objections(axle(), SEGMENT) == {}


SOUND = axle()
NOISE = np.random.default_rng(6).normal(0.0, 0.5, len(TIME))


@pytest.mark.parametrize(
    ("changed", "doubted"),
    [
        ({"shaft_torque_left_nm": NOISE, "shaft_torque_right_nm": NOISE[::-1]}, "shaft_torque_nm"),
        ({"shaft_torque_left_nm": NOISE}, "shaft_torque_nm"),
        (
            {
                "shaft_torque_left_nm": 0.5 * SOUND["shaft_torque_left_nm"],
                "shaft_torque_right_nm": 0.5 * SOUND["shaft_torque_right_nm"],
            },
            "shaft_torque_nm",
        ),
        ({"shaft_torque_right_nm": -SOUND["shaft_torque_right_nm"]}, "shaft_torque_right_nm"),
        ({"motor_speed_rad_s": -SOUND["motor_speed_rad_s"]}, "motor_speed_rad_s"),
        ({"motor_speed_rad_s": SOUND["wheel_speed_rad_s"]}, "motor_speed_rad_s"),
        ({"motor_speed_rad_s": SOUND["motor_speed_rad_s"] + 3.0 * TIME}, "wheel_speed_rad_s"),
        ({"wheel_speed_left_rad_s": 0.5 * SOUND["wheel_speed_left_rad_s"]}, "wheel_speed_rad_s"),
        ({"vehicle_speed_m_s": 0.5 * SOUND["vehicle_speed_m_s"]}, "vehicle_speed_m_s"),
        ({"motor_torque_nm": 0.3 * SOUND["motor_torque_nm"]}, "shaft_torque_nm"),
    ],
    ids=["both dead", "left dead", "both half", "right mirrored", "rotor mirrored", "rotor is wheel",
         "rotor drifts", "left wheel half", "vehicle half", "motor torque scaled"],
)  # fmt: skip
def test_a_sensor_that_contradicts_its_neighbours_is_doubted(changed: dict[str, Array], doubted: str) -> None:
    assert doubted in objections(axle(**changed), SEGMENT)


def test_wheels_need_not_roll_on_a_slippery_road() -> None:
    sliding = axle(vehicle_speed_m_s=0.5 * SOUND["vehicle_speed_m_s"])
    assert "vehicle_speed_m_s" in objections(sliding, SEGMENT)
    assert "vehicle_speed_m_s" in objections(sliding, SEGMENT.model_copy(update={"friction": 1.0}))
    assert objections(sliding, SEGMENT.model_copy(update={"friction": 0.05})) == {}


def test_drag_slip_and_efficiency_are_no_contradiction() -> None:
    torque = SOUND["shaft_torque_left_nm"] * 0.9
    changed = {
        "shaft_torque_left_nm": torque,
        "shaft_torque_right_nm": torque[::1] + 0.0,
        "vehicle_speed_m_s": 0.9 * SOUND["vehicle_speed_m_s"],
    }
    assert objections(axle(**changed), SEGMENT) == {}


def test_a_motor_that_only_shakes_proves_nothing_of_the_shaft() -> None:
    square = 150.0 * np.sign(np.sin(2 * np.pi * 45.0 * TIME)) * DRIVEN
    shaken = axle(motor_torque_nm=square, shaft_torque_left_nm=NOISE, shaft_torque_right_nm=NOISE[::-1])
    assert not any("T_s = N T_m" in text for text in objections(shaken, SEGMENT).values())


def test_every_channel_of_the_axle_has_a_proof() -> None:
    channels = set(SOUND.channels) - {"time_s", "motor_torque_ref_nm"}
    assert channels <= set(PROOFS)
    assert all(PROOFS[name] for name in channels)


def test_friction_that_is_as_large_at_every_torque_is_no_scale() -> None:
    small = {"motor_torque_ref_nm": 8.0 * DRIVEN, "motor_torque_nm": 8.0 * DRIVEN}
    torque = 0.5 * (8.0 * GEAR * DRIVEN - 25.0) + NOISE
    sides = {"shaft_torque_left_nm": torque, "shaft_torque_right_nm": torque - NOISE + NOISE[::-1]}
    assert objections(axle(**small, **sides), SEGMENT) == {}
    scaled = {name: 0.5 * values for name, values in sides.items()}
    assert "shaft_torque_nm" in objections(axle(**small, **scaled), SEGMENT)


DEAD = {"shaft_torque_left_nm": NOISE, "shaft_torque_right_nm": NOISE[::-1]}


def test_without_a_controller_the_speeds_tell_the_gear_ratio() -> None:
    unknown = SEGMENT.model_copy(update={"gear_ratio": None})
    assert objections(axle(), unknown) == {}
    assert "reads zero" in objections(axle(**DEAD), unknown)["shaft_torque_nm"]


def test_a_short_segment_is_looked_at_with_what_came_before_it() -> None:
    short = SEGMENT.model_copy(update={"start_s": 9.7, "step_s": 9.8, "end_s": 10.3})
    assert objections(axle(), short) == {}
    assert "shaft_torque_nm" in objections(axle(**DEAD), short)


def test_under_a_multisine_a_dead_sensor_is_found() -> None:
    tones = np.sum([2.0 * np.sin(2 * np.pi * f * TIME + f) for f in (1.0, 3.0, 7.0, 13.0, 21.0)], axis=0)
    excited = SEGMENT.model_copy(update={"kind": "multisine"})
    motor = {"motor_torque_ref_nm": tones, "motor_torque_nm": tones}
    torque = 0.5 * GEAR * tones + NOISE
    alive = {"shaft_torque_left_nm": torque, "shaft_torque_right_nm": torque + NOISE[::-1]}
    assert objections(axle(**motor, **alive), excited) == {}
    assert "reads zero" in objections(axle(**motor, **DEAD), excited)["shaft_torque_nm"]
    mirrored = {name: -values for name, values in alive.items()}
    assert "shaft_torque_nm" in objections(axle(**motor, **mirrored), excited)


def test_a_motor_torque_that_is_not_what_was_requested_is_doubted() -> None:
    assert "T_m = T_m*" in objections(axle(motor_torque_nm=0.0 * DRIVEN), SEGMENT)["motor_torque_nm"]


def test_a_shaft_that_twists_near_standstill_is_no_contradiction() -> None:
    wheel = 0.4 * DRIVEN
    twisting = 0.2 * ((STEP.step_s < TIME) & (STEP.step_s + 0.5 > TIME))
    noise = NOISE / 100
    slow = {
        "motor_speed_rad_s": GEAR * (wheel + twisting) + noise,
        "wheel_speed_left_rad_s": wheel + noise,
        "wheel_speed_right_rad_s": wheel + noise[::-1],
        "vehicle_speed_m_s": RADIUS_M * wheel,
    }
    short = SEGMENT.model_copy(update={"end_s": STEP.step_s + 1.0, "load": "speed"})
    assert objections(axle(**slow), short) == {}


SLIDING = 4.0 * DRIVEN  # by which the left wheel leads the mean, rad/s


def test_wheels_that_slide_apart_behind_a_differential_contradict_nothing() -> None:
    wheel = 2.0 + np.cumsum(DRIVEN) * 1.07e-3
    sliding = axle(wheel_speed_left_rad_s=wheel + SLIDING, wheel_speed_right_rad_s=wheel - SLIDING)
    assert objections(sliding, SEGMENT) == {}


@pytest.mark.parametrize("gear_ratio", [GEAR, None])
def test_half_a_sensor_is_no_wheel_that_slides(gear_ratio: float | None) -> None:
    half = axle(wheel_speed_left_rad_s=0.5 * SOUND["wheel_speed_left_rad_s"])
    segment = SEGMENT.model_copy(update={"gear_ratio": gear_ratio})
    assert "wheel_speed_left_rad_s" in objections(half, segment)
