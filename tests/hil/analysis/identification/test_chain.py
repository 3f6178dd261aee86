from __future__ import annotations

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.analysis.identification import chain_polynomials, chain_response, transfer_functions_of
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, TransferFunction
from tests.hil.analysis.identification.chains import RIGID, THREE, TWO

CHAINS = {"rigid": RIGID, "two_inertia": TWO, "three_inertia": THREE}
FREQUENCY = np.geomspace(0.05, 100, 60)


def state_space(p: dict[str, float]) -> control.StateSpace:
    """Three inertias straight from the equations of motion: speeds and the twists of shaft and tyre."""
    jm, n, jw, jv = (p[k] for k in ("motor_inertia", "gear_ratio", "wheel_inertia", "vehicle_inertia"))
    k, d, kt, dt = (p[x] for x in ("shaft_stiffness", "shaft_damping", "tyre_stiffness", "tyre_damping"))
    ts = np.array([d / n, -d, 0, k, 0])
    tt = np.array([0, dt, -dt, 0, kt])
    a = np.array([-ts / n / jm, (ts - tt) / jw, tt / jv, [1 / n, -1, 0, 0, 0], [0, 1, -1, 0, 0]])
    b = np.array([[1 / jm], [0], [0], [0], [0]])
    c = np.array([[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], ts])
    return control.ss(a, b, c, np.zeros((3, 1)))


def test_closed_form_is_the_equations_of_motion() -> None:
    system = state_space(THREE)
    reference = np.array(control.frequency_response(system, 2 * np.pi * FREQUENCY).frdata)[:, 0, :]
    reference = reference * np.exp(-2j * np.pi * FREQUENCY * THREE["torque_delay"])
    np.testing.assert_allclose(chain_response("three_inertia", THREE, FREQUENCY), reference, rtol=1e-9)


def test_a_very_stiff_tyre_makes_three_inertias_two() -> None:
    stiff = THREE | {"tyre_stiffness": 1e12, "tyre_damping": 0.0}
    merged = {k: v for k, v in THREE.items() if "tyre" not in k and k != "wheel_inertia"}
    merged["vehicle_inertia"] += THREE["wheel_inertia"]
    np.testing.assert_allclose(
        chain_response("three_inertia", stiff, FREQUENCY),
        chain_response("two_inertia", merged, FREQUENCY),
        rtol=1e-3,
    )


@pytest.mark.parametrize("kind", CHAINS)
@given(st.lists(st.floats(0.2, 5.0), min_size=9, max_size=9))
@settings(max_examples=25, deadline=None)
def test_polynomials_are_the_same_function(kind: str, factors: list[float]) -> None:
    values = {name: v * f for (name, v), f in zip(CHAINS[kind].items(), factors, strict=False)}
    functions, notes = transfer_functions_of(Model(kind, values))
    assert notes == ()
    expected = chain_response(kind, values, FREQUENCY)
    for name, row in zip(OUTPUTS, expected, strict=True):
        np.testing.assert_allclose(functions[name].response(FREQUENCY), row, rtol=1e-7)


def test_orders_and_exact_zeros_are_the_papers() -> None:
    numerators, denominator = chain_polynomials("three_inertia", THREE)
    assert [len(numerators[name]) - 1 for name in OUTPUTS] == [4, 3, 4]
    assert len(denominator) - 1 == 5
    assert denominator[-1] == 0.0
    assert numerators["shaft_torque_nm"][-1] == 0.0


def test_effects_are_left_out_with_a_note() -> None:
    backlash = EffectUse("backlash", EFFECTS["backlash"].check({"half_gap_rad": 0.02}, "test"))
    _, notes = transfer_functions_of(Model("three_inertia", THREE, (backlash,)))
    assert "backlash" in notes[0]


def test_unequal_denominators_are_refused() -> None:
    functions = {
        OUTPUTS[0]: TransferFunction((1.0,), (1.0, 0.0)),
        OUTPUTS[1]: TransferFunction((1.0,), (1.0, 2.0)),
    }
    with pytest.raises(BadInputError, match="another denominator"):
        transfer_functions_of(Model("transfer_function", transfer_functions=functions))
