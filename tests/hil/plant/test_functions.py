"""Transfer functions with many sets of effects, against closed forms and the chain of the same axle."""

from __future__ import annotations

import numpy as np
import pytest

from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model, TransferFunction
from hil.plant import Start, ideal_sensors, pack, simulate, simulate_many

PARAMETERS = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.0,
    "vehicle_inertia": 120.0,
    "viscous_drag": 0.0,
    "torque_delay": 0.004,
}
TOTAL = 0.02 * 64.0 + 120.0
FUNCTIONS = {
    OUTPUTS[0]: TransferFunction((64.0 / TOTAL,), (1.0, 0.0), 0.004),
    OUTPUTS[1]: TransferFunction((8.0 / TOTAL,), (1.0, 0.0), 0.004),
}
PATHS = (
    (),
    (EffectUse("dead_time", {"extra_delay_s": 0.0023}),),
    (EffectUse("dead_time", {"extra_delay_s": -0.0017}), EffectUse("torque_saturation", {"limit_nm": 12.0})),
    (
        EffectUse("actuator_lag", {"time_constant_s": 0.02}),
        EffectUse("torque_rate_limit", {"limit_nm_s": 900.0}),
    ),
)


def test_a_path_before_functions_acts_as_before_the_chain() -> None:
    rng = np.random.default_rng(0)
    torque = np.concatenate([np.zeros(50), np.repeat(rng.uniform(-30.0, 30.0, 40), 25)])
    starts = np.tile([24.0, 3.0, 0.0], (len(PATHS), 1))
    shown = []
    for model in (Model("rigid", PARAMETERS), Model("transfer_function", transfer_functions=FUNCTIONS)):
        slots = np.stack([pack(model.with_effects(*path)) for path in PATHS])
        sensors = ideal_sensors(len(PATHS))
        shown.append(
            simulate_many(slots, torque, 1e-3, starts, sensors, functions=model.transfer_functions or None)
        )
    of_chain, of_functions = shown
    assert of_functions[:, :, :2] == pytest.approx(of_chain[:, :, :2], abs=1e-6)
    assert np.all(of_functions[:, :, 2] == 0.0)  # no function for it


def test_an_axle_with_drag_coasts_down_from_its_start() -> None:
    slow = Model("transfer_function", transfer_functions={OUTPUTS[0]: TransferFunction((3.0,), (1.0, 0.2))})
    coasting = simulate(slow, np.zeros(2000), 1e-3, Start(50.0))[OUTPUTS[0]]
    assert coasting == pytest.approx(50.0 * np.exp(-0.2e-3 * np.arange(2000)), rel=1e-9)


def test_a_quick_output_begins_where_the_torque_before_held_it_and_forgets_it() -> None:
    quick = Model(
        "transfer_function", transfer_functions={OUTPUTS[2]: TransferFunction((40.0,), (1.0, 20.0))}
    )
    shaft = simulate(quick, np.zeros(500), 1e-3, Start(shaft_torque_nm=60.0))[OUTPUTS[2]]
    assert shaft == pytest.approx(60.0 * np.exp(-20e-3 * np.arange(500)), rel=1e-9)
