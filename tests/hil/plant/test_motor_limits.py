"""What the motor gives over speed, charge and temperature: by the energy that power leaves in a rotor."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, model_from_dict
from hil.fmu import Axle
from hil.plant import Start, ideal_sensors, pack, simulate, simulate_many
from tests.hil.plant.test_effects import THREE

RIGID = {
    "kind": "rigid",
    "parameters": {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "vehicle_inertia": 307.0,
        "viscous_drag": 0.0,
        "torque_delay": 0.0,
    },
}
INERTIA = 0.02 + 307.0 / 8.0**2
DT = 1e-3


def limited(**values: float) -> Model:
    effect = {"id": "motor_limits", "peak_nm": 100.0, "power_w": 5000.0, **values}
    return model_from_dict({**RIGID, "effects": [effect]}, "here")


def held(model: Model, torque_nm: float, speed_rad_s: float, seconds: float = 1.0) -> tuple[Any, Any]:
    """Motor torque and speed while a torque is asked for, from a speed of the rotor on."""
    start = Start(speed_rad_s, speed_rad_s / 8.0, motor_torque_nm=torque_nm)
    found = simulate(model, np.full(round(seconds / DT), torque_nm), DT, start)
    return found["motor_torque_nm"], found["motor_speed_rad_s"]


def test_at_low_speed_the_peak_limits() -> None:
    torque, speed = held(limited(), 150.0, 0.0)
    assert np.all(torque == 100.0)
    assert speed[-1] == pytest.approx(100.0 / INERTIA * (len(speed) - 1) * DT, rel=1e-9)


def test_at_high_speed_the_power_becomes_kinetic_energy() -> None:
    torque, speed = held(limited(), 150.0, 200.0, 4.0)
    assert torque == pytest.approx(5000.0 / speed, rel=2e-4)
    gained = 0.5 * INERTIA * (speed[-1] ** 2 - speed[0] ** 2)
    assert gained == pytest.approx(5000.0 * (len(speed) - 1) * DT, rel=2e-4)


def test_a_torque_within_its_limits_is_given() -> None:
    torque, _ = held(limited(), 20.0, 200.0, 0.1)
    assert np.all(torque == 20.0)


@pytest.mark.parametrize(
    ("charge", "asked", "power_w"),
    [
        (0.5, 150.0, 5000.0),
        (0.05, 150.0, 2500.0),  # half of what low_charge begins to take
        (0.0, 150.0, 0.0),
        (0.05, -150.0, 3000.0),  # an empty battery takes all
        (0.95, -150.0, 1500.0),
        (1.0, -150.0, 0.0),
        (1.0, 150.0, 5000.0),
    ],
)
def test_the_battery_limits_what_it_gives_and_takes(charge: float, asked: float, power_w: float) -> None:
    torque, speed = held(limited(regenerated_w=3000.0, state_of_charge=charge), asked, 250.0, 0.05)
    assert torque * speed == pytest.approx(np.copysign(power_w, asked), rel=1e-3, abs=1e-9)


@pytest.mark.parametrize(
    ("deg_c", "share"), [(20.0, 1.0), (120.0, 1.0), (150.0, 0.25), (160.0, 0.0), (200.0, 0.0)]
)
def test_heat_takes_torque_and_power(deg_c: float, share: float) -> None:
    assert held(limited(temperature_deg_c=deg_c), 150.0, 0.0, 0.01)[0][-1] == pytest.approx(100.0 * share)
    torque, speed = held(limited(temperature_deg_c=deg_c), -150.0, 400.0, 0.01)
    assert torque * speed == pytest.approx(-5000.0 * share, rel=1e-4)


def test_the_bench_has_the_same_motor_and_its_control_sees_what_it_gives() -> None:
    use = EffectUse("motor_limits", limited().effects[0].values | {"peak_nm": 60.0})
    axle = Axle(Model("three_inertia", THREE.parameters, (use,)), initial_speed_m_s=10.0)
    out = axle.play(np.full(1500, 100.0))
    power = out["motor_torque_nm"] * out["motor_speed_rad_s"]
    assert out["motor_torque_nm"].max() <= 60.0
    assert power[200:].max() < 5000.0 * 1.01  # limited at the sample's beginning
    assert out["motor_torque_ref_nm"][-1] == 100.0


def test_limits_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(BadInputError, match="not below hot_deg_c"):
        limited(warm_deg_c=160.0, hot_deg_c=120.0)


@pytest.mark.parametrize("slope", [(), (EffectUse("torque_rate_limit", {"limit_nm_s": 1500.0}),)])
@pytest.mark.parametrize("base", [model_from_dict(RIGID, "here"), Model("three_inertia", THREE.parameters)])
def test_the_equations_for_many_models_at_once_have_the_same_motor(
    base: Model, slope: tuple[EffectUse, ...]
) -> None:
    """A request beyond both limits and back, which a slope limit would take its time to leave."""
    model = base.with_effects(*limited(power_w=4000.0).effects, *slope)
    torque = 150.0 * np.sign(np.sin(np.arange(3000) * DT * 2.0 * np.pi))
    wheel = 60.0 / model.parameters["gear_ratio"]
    alone = simulate(model, torque, DT, Start(60.0, wheel, motor_torque_nm=0.0))
    begins = np.array([[60.0, wheel, 0.0]])
    many = simulate_many(pack(model)[None], torque, DT, begins, ideal_sensors(1), before_nm=0.0)[0]
    for name, shown in zip(OUTPUTS[:2], many.T, strict=False):
        assert np.max(np.abs(shown - alone[name])) < 2e-3 * np.max(np.abs(alone[name])), name
