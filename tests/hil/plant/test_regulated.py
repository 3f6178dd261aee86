"""Wheels that turn as recorded: both integrators follow, and what is asked of the rest has closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from hil.core.channels import INPUT, TIME, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import followed, given_outputs, pack, replay, turning_of

Array = npt.NDArray[np.float64]

DT = 1e-3
TIME_S: Array = np.arange(8000, dtype=np.float64) * DT
WHEEL = 12.0 + 6.0 * np.sin(2.0 * np.pi * 0.7 * TIME_S) + 0.5 * np.sin(2.0 * np.pi * 6.0 * TIME_S)
SLOPE = 6.0 * 2 * np.pi * 0.7 * np.cos(2.0 * np.pi * 0.7 * TIME_S) + 6.0 * np.pi * np.cos(
    12.0 * np.pi * TIME_S
)
RATIO, ROTOR, DRAG = 8.0, 0.02, 0.01
_ROTOR = {"motor_inertia": ROTOR, "gear_ratio": RATIO, "torque_delay": 0.0}
_SHAFTS = _ROTOR | {"shaft_stiffness": 6000.0, "shaft_damping": 20.0}
_TYRE = {"wheel_inertia": 4.0, "tyre_stiffness": 5000.0, "tyre_damping": 300.0}
LOAD = "wheel_speed_rad_s"
RIGID = Model("rigid", _ROTOR | {"vehicle_inertia": 3.0, "viscous_drag": DRAG}, load_input=LOAD)
CHAINS = (
    Model("two_inertia", _SHAFTS | {"vehicle_inertia": 3.0}, load_input=LOAD),
    Model("three_inertia", _SHAFTS | _TYRE | {"vehicle_inertia": 300.0}, load_input=LOAD),
)


def recorded(torque: Array, **channels: Array) -> Recording:
    return Recording({TIME: TIME_S, INPUT: torque, **channels}, Path("regulated.csv"))


def test_a_rigid_axle_asks_its_shafts_for_what_the_motor_does_not_need_itself() -> None:
    torque = 10.0 * np.sign(np.sin(3.0 * TIME_S))
    shown = replay(RIGID, recorded(torque, wheel_speed_rad_s=WHEEL))
    acted = np.concatenate([torque[:1], torque[:-1]])
    asked = RATIO * (acted - ROTOR * RATIO * SLOPE - DRAG * RATIO * WHEEL)
    inside = slice(100, -100)
    assert shown["wheel_speed_rad_s"][inside] == pytest.approx(WHEEL[inside], abs=2e-3)
    assert shown["shaft_torque_nm"][inside] == pytest.approx(asked[inside], abs=0.3)


@pytest.mark.parametrize("model", CHAINS, ids=lambda one: one.kind)
def test_a_rotor_swings_against_wheels_that_nothing_else_turns(model: Model) -> None:
    """At a frequency far below its resonance it follows them; its torque goes into the shafts."""
    torque = np.full(len(TIME_S), 5.0)
    shown = replay(model, recorded(torque, wheel_speed_rad_s=WHEEL))
    settled = slice(3000, -100)
    assert shown["wheel_speed_rad_s"][settled] == pytest.approx(WHEEL[settled], abs=5e-3)
    asked = RATIO * (5.0 - ROTOR * RATIO * SLOPE)
    assert np.std((shown["shaft_torque_nm"] - asked)[settled]) < 0.35 * np.std(asked[settled])
    assert np.mean(shown["shaft_torque_nm"][settled]) == pytest.approx(np.mean(asked[settled]), rel=0.02)


def test_what_is_noise_of_a_speed_does_not_turn_the_wheels() -> None:
    noisy = WHEEL + np.random.default_rng(0).normal(0.0, 0.02, len(WHEEL))
    found = turning_of(noisy, DT)
    inside = slice(200, -200)
    by_differences = np.gradient(noisy, DT)
    assert np.std((found.slope - SLOPE)[inside]) < 0.04 * np.std((by_differences - SLOPE)[inside])
    assert found.speed[0] == pytest.approx(WHEEL[0], abs=5e-3)
    assert found.noise_at(np.array([0.4])) == pytest.approx([0.02**2], rel=0.2)
    assert found.noise_at(np.array([100.0])) < 0.1 * 0.02**2


def test_the_gain_of_a_rigid_axle_is_that_of_its_inertia() -> None:
    hz = np.array([2.0, 20.0])
    gain = followed(pack(RIGID), hz)
    assert gain[0] == pytest.approx([RATIO, RATIO])
    assert gain[2] == pytest.approx(RATIO**2 * np.hypot(ROTOR * 2 * np.pi * hz, DRAG), rel=1e-3)


def test_a_wheels_angle_or_a_rigid_axles_motor_speed_does_as_well() -> None:
    torque = np.full(len(TIME_S), 5.0)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * DT * (WHEEL[1:] + WHEEL[:-1]))])
    plain = replay(RIGID, recorded(torque, wheel_speed_rad_s=WHEEL))["shaft_torque_nm"]
    for channels in ({WHEEL_ANGLE: angle}, {"motor_speed_rad_s": RATIO * WHEEL}):
        shown = replay(RIGID, recorded(torque, **channels))["shaft_torque_nm"]
        assert shown[100:-100] == pytest.approx(plain[100:-100], abs=0.3)
    with pytest.raises(BadInputError, match="no channel wheel_speed_rad_s"):
        replay(CHAINS[0], recorded(torque, motor_speed_rad_s=RATIO * WHEEL))


def test_what_turns_as_recorded_is_not_compared() -> None:
    assert given_outputs(RIGID).tolist() == [True, True, False]
    assert given_outputs(CHAINS[0]).tolist() == [False, True, False]
    assert not given_outputs(Model("rigid", RIGID.parameters)).any()
