"""Benches that regulate the speed: what is missing is found from the torque that the motion takes.

Both plants are formulas of this file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from hil.analysis.diagnosis import diagnose
from hil.core.model import Model
from hil.core.recording import Recording

pytestmark = pytest.mark.slow

Array = npt.NDArray[np.float64]

DT = 1e-3
LOAD = "wheel_speed_rad_s"


def motor(
    seconds: float, seed: int, *, dry: float = 0.0, ripple: float = 0.0, counts: int = 0, rests: bool = False
) -> Recording:
    """A motor of 0.02 kg m² and 0.01 N m s/rad on a torque flange; a machine holds its speed."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds / DT), dtype=np.float64) * DT
    speed = 60 * np.sin(0.8 * time + seed) + 20 * np.sin(3.1 * time) + 5 * np.sin(11 * time)
    slope = 48 * np.cos(0.8 * time + seed) + 62 * np.cos(3.1 * time) + 55 * np.cos(11 * time)
    angle = -75 * np.cos(0.8 * time + seed) - 20 / 3.1 * np.cos(3.1 * time) - 5 / 11 * np.cos(11 * time)
    if rests:  # at first, for a second and a half, brought to where it goes on within a half
        rise = np.clip((time - 1.5) / 0.5, 0.0, 1.0)
        rate = np.where((rise > 0.0) & (rise < 1.0), 2.0, 0.0)
        smooth, bend = rise**2 * (3.0 - 2.0 * rise), 6.0 * rise * (1.0 - rise) * rate
        speed, slope = speed * smooth, slope * smooth + speed * bend
        angle = np.concatenate([[0.0], np.cumsum(0.5 * DT * (speed[1:] + speed[:-1]))])
    torque = 8 * np.sign(np.sin(0.37 * time + seed)) + 3 * np.sin(2 * time) + 2 * np.sin(9 * time)
    acts = np.concatenate([torque[:1], torque[:-1]])
    flange = acts - 0.02 * slope - 0.01 * speed - dry * np.sign(speed) + ripple * np.sin(6 * angle + 0.3)
    channels = {
        "time_s": time,
        "motor_torque_ref_nm": torque,
        "motor_speed_rad_s": speed + rng.normal(0.0, 0.02, len(time)),
        "shaft_torque_nm": flange + rng.normal(0.0, 0.05, len(time)),
        "wheel_angle_rad": angle,
    }
    if counts:
        step = 2 * np.pi / counts
        channels = {name: channels[name] for name in ("time_s", "motor_torque_ref_nm", "shaft_torque_nm")}
        channels["motor_angle_rad"] = np.floor(angle / step) * step
    return Recording(channels, Path(f"motor {seed}.csv"))


def axle(seconds: float, seed: int, viscous: float) -> Recording:
    """Rotor and shafts on wheels whose speed is held, in steps of 50 µs; the torque is a chirp."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds / DT), dtype=np.float64) * DT
    torque = 20 * np.sin(2 * np.pi * np.cumsum(1.0 + 29.0 * time / seconds) * DT) + 5 * np.sin(0.9 * time)
    torque[:300] = 0.0
    fine = np.arange(20 * len(time)) * DT / 20
    wheel = 6 * np.sin(0.5 * fine + seed) + np.sin(7 * fine) + 8 * np.sin(0.13 * fine)
    shown, speed, twist, h = np.empty((len(time), 2)), 8.0 * wheel[0], 0.0, DT / 20
    for k, asked in enumerate(np.concatenate([np.zeros(4), torque[:-4]]).tolist()):
        for turning in wheel[20 * k : 20 * k + 20].tolist():
            rate = speed / 8.0 - turning
            shaft = 6000.0 * twist + 20.0 * rate
            if turning == wheel[20 * k]:
                shown[k] = speed, shaft
            speed += h * (asked - shaft / 8.0 - viscous * speed) / 0.02
            twist += h * rate
    noise = rng.normal(0.0, (0.1, 2.0, 0.01), (len(time), 3))
    channels = {"time_s": time, "motor_torque_ref_nm": torque}
    seen = np.column_stack([shown, wheel[::20]]) + noise
    return Recording(
        channels | dict(zip(("motor_speed_rad_s", "shaft_torque_nm", LOAD), seen.T, strict=True)),
        Path(f"axle {seed}.csv"),
    )


def test_friction_and_ripple_of_a_motor_are_found_by_its_flange() -> None:
    numbers = {"motor_inertia": 0.018, "gear_ratio": 1.0, "vehicle_inertia": 0.02, "viscous_drag": 0.01}
    base = Model("rigid", numbers | {"torque_delay": 0.0}, load_input=LOAD)
    fit, held = motor(20.0, 1, dry=0.5, ripple=0.4), motor(10.0, 2, dry=0.5, ripple=0.4)
    found = diagnose(base, [fit], [held])
    named = {one.use.id: one.use.values for one in found.effects}
    assert named.keys() == {"coulomb_friction", "motor_order_ripple"}
    assert named["coulomb_friction"]["torque_nm"] == pytest.approx(0.5, rel=0.01)
    assert named["motor_order_ripple"]["amplitude_nm"] == pytest.approx(0.4, rel=0.01)
    assert found.model.parameters["motor_inertia"] == pytest.approx(0.02, rel=2e-3)
    assert found.model.load_input == LOAD
    assert {*found.holdout_after} == {"shaft_torque_nm"}
    assert found.holdout_after["shaft_torque_nm"].noises < 1.1


@pytest.mark.parametrize("given", [{"rests": True}, {"counts": 4096}])
def test_a_rest_or_the_steps_of_an_encoder_take_nothing_from_friction(given: dict[str, Any]) -> None:
    """Held at rest friction may be anything; steps differentiated twice would be most of the torque."""
    numbers = {"motor_inertia": 0.018, "gear_ratio": 1.0, "vehicle_inertia": 0.02, "viscous_drag": 0.01}
    base = Model("rigid", numbers | {"torque_delay": 0.0}, load_input=LOAD)
    found = diagnose(base, [motor(20.0, 1, dry=0.5, **given)], [motor(10.0, 2, dry=0.5, **given)])
    assert [one.use.id for one in found.effects] == ["coulomb_friction"]
    assert found.effects[0].use.values["torque_nm"] == pytest.approx(0.5, rel=0.01)
    assert found.effects[0].confidence > 0.95
    assert found.holdout_after["shaft_torque_nm"].noises < 1.15


def test_nothing_is_missing_of_a_motor_without_either() -> None:
    numbers = {"motor_inertia": 0.02, "gear_ratio": 1.0, "vehicle_inertia": 0.02, "viscous_drag": 0.01}
    base = Model("rigid", numbers | {"torque_delay": 0.0}, load_input=LOAD)
    found = diagnose(base, [motor(20.0, 1)], [motor(10.0, 2)])
    assert (found.verdict, found.effects) == ("none", ())


def test_drag_of_a_rotor_is_found_where_the_wheels_are_held() -> None:
    numbers = {"motor_inertia": 0.02, "gear_ratio": 8.0, "shaft_stiffness": 5500.0, "shaft_damping": 20.0}
    base = Model("two_inertia", numbers | {"vehicle_inertia": 1.0, "torque_delay": 0.004}, load_input=LOAD)
    found = diagnose(base, [axle(12.0, 1, 0.01)], [axle(8.0, 2, 0.01)])
    (drag,) = found.effects
    assert drag.use.id == "viscous_drag"
    assert drag.use.values["coefficient_nms_rad"] == pytest.approx(0.01, rel=0.02)
    assert found.model.parameters["shaft_stiffness"] == pytest.approx(6000.0, rel=2e-3)
    assert found.model.parameters["vehicle_inertia"] == 1.0
    assert all(one.noises < 1.1 for one in found.holdout_after.values())
