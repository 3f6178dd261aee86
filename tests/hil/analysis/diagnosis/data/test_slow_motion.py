"""What chain and transfer functions of one axle say of slow motion, and which outputs are compared."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.slow_motion import slow_motion_of, with_outputs_of
from hil.core.channels import MOTOR_ANGLE, OUTPUTS, TIME, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction
from hil.core.recording import Recording

RATIO, ROTOR, LOAD = 8.0, 0.02, 120.0
TOTAL = ROTOR * RATIO**2 + LOAD
#: A rigid axle: torque over inertia, and what of it the load takes.
RIGID = {
    OUTPUTS[0]: TransferFunction((RATIO**2 / TOTAL,), (1.0, 0.0)),
    OUTPUTS[1]: TransferFunction((RATIO / TOTAL,), (1.0, 0.0)),
    OUTPUTS[2]: TransferFunction((RATIO * LOAD / TOTAL,), (1.0,)),
}


def recorded(*names: str) -> Recording:
    return Recording({TIME: np.arange(3.0), **{n: np.zeros(3) for n in names}}, Path("r.csv"))


def test_functions_and_chain_of_one_axle_agree() -> None:
    chain = Model(
        "rigid",
        {"motor_inertia": ROTOR, "gear_ratio": RATIO, "vehicle_inertia": LOAD, "viscous_drag": 0.0},
    )
    for model in (chain, Model("transfer_function", transfer_functions=RIGID)):
        slow = slow_motion_of(model)
        assert slow is not None
        assert (slow.gear_ratio, slow.inertia_kg_m2) == pytest.approx((RATIO, TOTAL))
        assert slow.rotor_kg_m2 == pytest.approx(ROTOR * RATIO**2)


@pytest.mark.parametrize("missing", OUTPUTS)
def test_functions_without_an_output_do_not_tell(missing: str) -> None:
    left = {name: function for name, function in RIGID.items() if name != missing}
    assert slow_motion_of(Model("transfer_function", transfer_functions=left)) is None


def test_only_outputs_with_a_function_are_kept() -> None:
    motor = Model("transfer_function", transfer_functions={OUTPUTS[0]: RIGID[OUTPUTS[0]]})
    kept = with_outputs_of(motor, recorded(*OUTPUTS))
    assert {*kept.channels} == {TIME, OUTPUTS[0]}
    assert any(OUTPUTS[2] in note for note in kept.notes)
    same = recorded(OUTPUTS[0])
    assert with_outputs_of(motor, same) is same
    with pytest.raises(BadInputError, match="no function for any"):
        with_outputs_of(motor, recorded(OUTPUTS[1]))
    with pytest.raises(BadInputError, match="no function for any"):
        with_outputs_of(motor, recorded(WHEEL_ANGLE))
    angle = recorded(MOTOR_ANGLE)
    assert with_outputs_of(motor, angle) is angle
