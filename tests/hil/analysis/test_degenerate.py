"""Diagnosis, identification and design of what no bench should make: a result or a message, never else."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.analysis.control_design import DesignSpec, design
from hil.analysis.diagnosis import diagnose
from hil.analysis.frequency_response import experiments_of
from hil.analysis.identification import identify
from hil.core.channels import OUTPUTS
from hil.core.errors import HilError
from hil.core.model import Model, TransferFunction, parameter_names
from reports.outputs.control_design import output_files
from tests.hil.analysis.degenerate import CHANGES, MODEL, SHAPES, recording

pytestmark = pytest.mark.filterwarnings("ignore")

#: What takes long because nothing is wrong with it in the end; run by `make hunt`.
_LONG = (
    *("jitter", "a gap", "tiny torque", "rounded time", "early start", "step only"),
    *("constant motor_torque_ref_nm", "zero motor_torque_ref_nm"),
)
FAST = [
    (change, shape)
    for change, shape in itertools.product(CHANGES, ("4000 samples", "every 10 us", "199 samples"))
    if change not in _LONG
]
REST = [
    (change, shape) for change, shape in itertools.product(CHANGES, SHAPES) if (change, shape) not in FAST
]


def survives_diagnosis(change: str, shape: str, seed: int = 0) -> None:
    try:
        found = diagnose(MODEL, [recording(change, shape, seed)])
    except HilError as error:
        assert len(str(error)) > 20
        return
    assert found.verdict in ("named", "none", "unknown")
    assert all(math.isfinite(gap.gap) for gap in found.gap_after.values())


def survives_identification(change: str, shape: str, order: int | None, seed: int = 0) -> None:
    try:
        found = identify(experiments_of(recording(change, shape, seed)), order=order)
    except HilError as error:
        assert len(str(error)) > 20
        return
    for function in found.model.transfer_functions.values():
        assert np.all(np.isfinite([*function.numerator, *function.denominator, function.delay_s]))


@pytest.mark.slow
@pytest.mark.parametrize(("change", "shape"), FAST)
def test_diagnosis(change: str, shape: str) -> None:
    survives_diagnosis(change, shape)


@pytest.mark.hunt
@pytest.mark.parametrize(("change", "shape"), REST)
def test_diagnosis_of_the_rest(change: str, shape: str) -> None:
    survives_diagnosis(change, shape)


@pytest.mark.parametrize("shape", ["200 samples", "3 samples", "every 10 us"])
@pytest.mark.parametrize("change", CHANGES)
def test_identification(change: str, shape: str) -> None:
    survives_identification(change, shape, order=3)


@pytest.mark.hunt
@pytest.mark.parametrize("shape", ["4000 samples", "every 0.1 s", "every 20 ms"])
@pytest.mark.parametrize("change", CHANGES)
def test_identification_of_what_can_be_fitted(change: str, shape: str) -> None:
    survives_identification(change, shape, order=None)


SIZES = st.floats(-12, 12).map(lambda exponent: 10.0**exponent)


@st.composite
def chains(draw: st.DrawFn) -> Model:
    """A chain of any sizes that a model file may hold."""
    kind = draw(st.sampled_from(["two_inertia", "three_inertia", "rigid"]))
    parameters = {name: draw(SIZES) for name in parameter_names(kind)}
    parameters["torque_delay"] = draw(st.floats(0.0, 0.1))
    return Model(kind, parameters)


@st.composite
def functions(draw: st.DrawFn) -> Model:
    """Transfer functions of any coefficients over one denominator."""
    order = draw(st.integers(1, 7))
    number = st.one_of(st.sampled_from([0.0, 1.0, -1.0]), st.floats(allow_nan=False, allow_infinity=False))
    denominator = (draw(number.filter(bool)), *(draw(number) for _ in range(order)))
    each = {
        name: TransferFunction(
            tuple(draw(number) for _ in range(draw(st.integers(1, order + 1)))), denominator
        )
        for name in OUTPUTS
    }
    return Model("transfer_function", transfer_functions=each)


def survives_design(model: Model, pole: float = 0.3) -> None:
    try:
        found = design(model, DesignSpec(pole_rad_s=pole, wheel_inertia_kg_m2=4.0))
    except HilError as error:
        assert len(str(error)) > 20
        return
    assert found.loop(found.chosen).margins.stable
    assert np.isfinite(found.controller.wsc.proportional_gain)


@given(st.one_of(chains(), functions()), st.floats(1e-3, 100.0))
@settings(max_examples=15, deadline=None)
def test_design(model: Model, pole: float) -> None:
    survives_design(model, pole)


@pytest.mark.hunt
@given(st.one_of(chains(), functions()), st.floats(1e-6, 3000.0))
@settings(max_examples=1000, deadline=None)
def test_design_of_many(model: Model, pole: float) -> None:
    survives_design(model, pole)


@pytest.mark.hunt
def test_figures_of_a_loop_without_any_good_lead() -> None:
    model = MODEL.with_parameters(torque_delay=0.2)
    found = design(model, DesignSpec(pole_rad_s=3.0), unstable_too=True)
    assert {"nyquist.svg", "trade_off.svg"} <= set(output_files(found, None))
