"""Transfer functions of a chain with its linear effects, against its matrices frequency by frequency."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.analysis.control_design import design_plant
from hil.analysis.identification import transfer_functions_of
from hil.analysis.identification._chain import linear_effects
from hil.core.model import EffectUse, Model, load_model
from hil.plant import linear_system
from tests.benches_for_tests import SIM

CHAIN = load_model(SIM.simulation.model)
FREQUENCY = np.geomspace(0.05, 100.0, 60)
LATE = EffectUse("dead_time", {"extra_delay_s": 0.003})
LAG = EffectUse("actuator_lag", {"time_constant_s": 0.004})
MOUNT = EffectUse(
    "mount_mode",
    {"housing_inertia_kg_m2": 3.0, "mount_stiffness_nm_rad": 1e4, "mount_damping_nms_rad": 10.0},
)
BACKLASH = EffectUse("backlash", {"half_gap_rad": 0.01})
OFFSET = EffectUse("sensor_offset", {"channel": "motor_speed_rad_s", "offset": 1.0})


def told(model: Model) -> np.ndarray:
    """Responses by the transfer functions."""
    functions, _ = transfer_functions_of(model)
    return np.array([function.response(FREQUENCY) for function in functions.values()])


@pytest.mark.parametrize("effects", [(LATE,), (LAG,), (MOUNT,), (LATE, LAG, MOUNT)], ids=str)
@given(factors=st.lists(st.floats(0.3, 3.0), min_size=9, max_size=9))
@settings(max_examples=15, deadline=None)
def test_responses_are_those_of_the_matrices(effects, factors) -> None:
    names = zip(CHAIN.parameters.items(), factors, strict=False)
    model = replace(CHAIN, parameters={name: value * f for (name, value), f in names}, effects=effects)
    expected = linear_system(model).response(FREQUENCY)
    np.testing.assert_allclose(told(model), expected, rtol=1e-6)


def test_what_is_not_linear_is_left_out_and_said() -> None:
    model = replace(CHAIN, effects=(BACKLASH, LATE, OFFSET))
    assert linear_effects(model) == (LATE,)
    functions, notes = transfer_functions_of(model)
    assert notes == ("effects of the model are left out of the linear design: backlash, sensor_offset",)
    late = CHAIN.parameters["torque_delay"] + 0.003
    assert [function.delay_s for function in functions.values()] == pytest.approx([late] * 3)


def test_a_design_counts_the_dead_time_that_a_diagnosis_has_found() -> None:
    plain, late = design_plant(CHAIN), design_plant(replace(CHAIN, effects=(LATE,)))
    assert late.delay_s - plain.delay_s == pytest.approx(0.003)
    assert late.resonance_hz == pytest.approx(plain.resonance_hz)
