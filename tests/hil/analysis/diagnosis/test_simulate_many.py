"""The plant for fits against the plant of `hil simulate`."""

from __future__ import annotations

import numpy as np
import pytest

from hil.core.model import EffectUse, Model
from hil.plant import Start, ideal_sensors, pack, simulate, simulate_many
from tests.hil.analysis.diagnosis.reference_plant import BASE, CHANNELS

MODEL = Model("three_inertia", dict(BASE) | {"torque_delay": 0.0083})
TIME = np.arange(4000) * 1e-3
TORQUE = 5.0 + 20.0 * np.sin(2 * np.pi * (0.3 * TIME + 1.5 * TIME**2))


@pytest.mark.parametrize(
    "use",
    [
        None,
        EffectUse("actuator_lag", {"time_constant_s": 0.01}),
        EffectUse("torque_saturation", {"limit_nm": 12.0}),
        EffectUse("torque_rate_limit", {"limit_nm_s": 400.0}),
        EffectUse("torque_deadband", {"half_width_nm": 2.0}),
        EffectUse("torque_gain", {"gain": 0.93}),
        EffectUse("backlash", {"half_gap_rad": 0.01}),
        EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": 1e5}),
        EffectUse("shaft_hysteresis", {"stiffness_nm_rad": 800.0, "slip_rad": 0.01}),
        EffectUse("coulomb_friction", {"torque_nm": 2.0, "stribeck_torque_nm": 0.5, "offset_nm": 0.1}),
        EffectUse("viscous_drag", {"coefficient_nms_rad": 0.02}),
        EffectUse(
            "mount_mode",
            {"housing_inertia_kg_m2": 2.0, "mount_stiffness_nm_rad": 2e4, "mount_damping_nms_rad": 30.0},
        ),
        EffectUse("running_resistance", {"rolling_nm": 20.0, "aero_nms2_rad2": 0.05}),
        EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 20.0, "phase_rad": 0.3}),
        EffectUse("motor_order_ripple", {"order": 2.0, "amplitude_nm": 0.5, "phase_rad": 0.3}),
    ],
)
def test_both_plants_agree(use: EffectUse | None) -> None:
    model = MODEL.with_effects(*([use] if use else []))
    start = Start(80.0, 80.0 / BASE["gear_ratio"], 40.0)
    expected = simulate(model, TORQUE, 1e-3, start)
    begin = np.array([[start.motor_speed_rad_s, start.wheel_speed_rad_s, start.shaft_torque_nm]])
    found = simulate_many(pack(model)[None], TORQUE, 1e-3, begin, ideal_sensors(1))[0]
    for column, channel in enumerate(CHANNELS):
        spread = np.std(expected[channel])
        assert np.sqrt(np.mean((found[:, column] - expected[channel]) ** 2)) < 5e-3 * spread, channel


@pytest.mark.parametrize("kind", ["rigid", "two_inertia"])
def test_the_smaller_kinds_agree_too(kind: str) -> None:
    parameters = {k: BASE[k] for k in ("motor_inertia", "gear_ratio", "vehicle_inertia", "torque_delay")}
    more = (
        {"viscous_drag": 0.01}
        if kind == "rigid"
        else {k: BASE[k] for k in ("shaft_stiffness", "shaft_damping")}
    )
    model = Model(kind, parameters | more)
    expected = simulate(model, TORQUE, 1e-3)
    found = simulate_many(pack(model)[None], TORQUE, 1e-3, np.zeros((1, 3)), ideal_sensors(1))[0]
    for column, channel in enumerate(CHANNELS):
        assert np.allclose(found[:, column], expected[channel], rtol=1e-6, atol=1e-6), channel


@pytest.mark.parametrize("delay", [0.008, 0.0083, 0.00895])
def test_a_rigid_axle_shows_a_slewing_torque_at_each_instant(delay: float) -> None:
    parameters = {k: BASE[k] for k in ("motor_inertia", "gear_ratio", "vehicle_inertia")}
    model = Model("rigid", {**parameters, "viscous_drag": 0.01, "torque_delay": delay})
    model = model.with_effects(EffectUse("torque_rate_limit", {"limit_nm_s": 400.0}))
    expected = simulate(model, TORQUE, 1e-3)
    found = simulate_many(pack(model)[None], TORQUE, 1e-3, np.zeros((1, 3)), ideal_sensors(1))[0]
    apart = np.abs(found[:, 2] - expected[CHANNELS[2]])[20:]
    assert np.max(apart) < 2e-3 * np.ptp(expected[CHANNELS[2]])


def test_a_stuck_rotor_stays_where_it_is() -> None:
    model = MODEL.with_effects(
        EffectUse("coulomb_friction", {"torque_nm": 5.0, "stribeck_torque_nm": 0.0, "offset_nm": 0.0})
    )
    torque = np.full(3000, 2.0)
    found = simulate_many(pack(model)[None], torque, 1e-3, np.zeros((1, 3)), ideal_sensors(1))[0]
    assert abs(found[-500:, 0].mean()) < 1e-3
