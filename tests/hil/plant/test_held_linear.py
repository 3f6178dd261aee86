"""The linear part of the driveline over one held step, against scipy's matrix exponential."""

import numpy as np
import pytest
from scipy.linalg import expm

from hil.core.model import EffectUse, Model
from hil.plant import pack, system
from hil.plant._held_linear import held_step

THREE = Model(
    "three_inertia",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.148,
        "shaft_stiffness": 6089.0,
        "shaft_damping": 19.75,
        "wheel_inertia": 4.355,
        "tyre_stiffness": 5717.0,
        "tyre_damping": 351.0,
        "vehicle_inertia": 303.0,
        "torque_delay": 0.008,
    },
)


def mount(stiffness: float, damping: float) -> EffectUse:
    values: dict[str, float | str] = {
        "housing_inertia_kg_m2": 2.0,
        "mount_stiffness_nm_rad": stiffness,
        "mount_damping_nms_rad": damping,
    }
    return EffectUse("mount_mode", values)


@pytest.mark.parametrize("duration", [0.0, 1e-5, 1e-3, 1e-2])
@pytest.mark.parametrize(
    "effects",
    [(), (mount(2e4, 30.0),), (mount(5e8, 2e4),), (EffectUse("actuator_lag", {"time_constant_s": 1e-5}),)],
)
def test_a_held_step_is_the_exponential_of_the_system_with_its_inputs(effects, duration):
    a, b = system(pack(THREE.with_effects(*effects)))
    states, inputs = b.shape
    block = np.zeros((states + 2 * inputs,) * 2)
    block[:states, :states], block[:states, states : states + inputs] = a, b
    block[states : states + inputs, states + inputs :] = np.eye(inputs) / max(duration, 1e-12)
    power = expm(block * duration)[:states]
    expected = power[:, :states], power[:, states : states + inputs], power[:, states + inputs :]
    for found, exact in zip(held_step(a, b, duration), expected, strict=True):
        np.testing.assert_allclose(found, exact, rtol=1e-9, atol=1e-11 * np.max(np.abs(exact)))


def test_momentum_is_kept_to_the_last_digit():
    a, _ = system(pack(THREE))
    transition, _, _ = held_step(a, np.zeros((8, 6)), 1e-3)
    p = THREE.parameters
    momentum = np.zeros(8)
    momentum[[0, 2, 4]] = p["motor_inertia"] * p["gear_ratio"], p["wheel_inertia"], p["vehicle_inertia"]
    np.testing.assert_allclose(momentum @ transition, momentum, rtol=1e-14, atol=1e-12)
