from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.control_design import design_plant, feed_forward, speed_filter
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction
from tests.hil.analysis import paper_plant
from tests.hil.analysis.identification.chains import RIGID, THREE, TWO

FREQUENCY = np.geomspace(0.05, 30, 50)


def filters(model: Model) -> tuple[TransferFunction, TransferFunction]:
    plant = design_plant(model).filters
    motor, wheel, shaft = (
        TransferFunction(n, plant.denominator)
        for n in (plant.motor_speed, plant.wheel_speed, plant.shaft_torque)
    )
    return speed_filter(motor, wheel, 0.05), feed_forward(shaft, 0.05)


def with_shaft_numerator(model: Model, numerator: np.ndarray) -> Model:
    shaft = TransferFunction(tuple(float(c) for c in numerator), paper_plant.DENOMINATOR, 0.008)
    return replace(model, transfer_functions=model.transfer_functions | {OUTPUTS[2]: shaft})


def test_papers_figures(paper_model: Model) -> None:
    plant = design_plant(paper_model)
    assert plant.resonance_hz == pytest.approx(10.583, abs=5e-4)
    assert plant.inertia_kg_m2 == pytest.approx(4.524, abs=5e-4)
    assert plant.gear_ratio == pytest.approx(8.148, abs=5e-4)
    assert plant.delay_s == 0.008
    assert plant.notes == ()
    assert plant.filters.shaft_torque == paper_plant.NUMERATORS[OUTPUTS[2]]


def test_right_half_plane_zeros_are_mirrored(paper_model: Model) -> None:
    """A zero pair at 15 Hz to the right: the feed-forward stays stable and keeps its gain."""
    zeros = np.poly([20 + 90j, 20 - 90j, -40, 0])
    model = with_shaft_numerator(paper_model, 200 * np.real(zeros))
    plant = design_plant(model)
    assert any("mirrored" in note and "(18)" in note for note in plant.notes)
    _, forward = filters(model)
    assert np.all(np.roots(forward.denominator).real < 0)
    shaft = model.transfer_functions[OUTPUTS[2]]
    expected = 1 / np.abs(shaft.response(FREQUENCY)) / np.abs(1 + 0.05 * 2j * np.pi * FREQUENCY)
    np.testing.assert_allclose(np.abs(forward.response(FREQUENCY)), expected, rtol=1e-6)
    assert np.sign(forward.response(np.array([1e-3]))[0].real) == 1


def test_zeros_that_would_ring_are_damped(paper_model: Model) -> None:
    zeros = np.poly([60j, -60j, -40, 0])
    model = with_shaft_numerator(paper_model, 200 * np.real(zeros))
    assert any("hardly any damping" in note for note in design_plant(model).notes)
    _, forward = filters(model)
    assert np.max(np.roots(forward.denominator).real) < -1


@pytest.mark.parametrize("damping", [0.0, 19.75])
@pytest.mark.parametrize(("kind", "values"), [("two_inertia", TWO), ("three_inertia", THREE)])
def test_chains_give_stable_proper_filters(kind: str, values: dict[str, float], damping: float) -> None:
    model = Model(kind, values | {"shaft_damping": damping})
    plant = design_plant(model)
    for part in filters(model):
        assert np.all(np.roots(part.denominator).real < 0)
        assert len(part.numerator) <= len(part.denominator)
    assert plant.gear_ratio == pytest.approx(values["gear_ratio"])
    total = (
        values["motor_inertia"]
        + (values["vehicle_inertia"] + values.get("wheel_inertia", 0.0)) / values["gear_ratio"] ** 2
    )
    assert plant.inertia_kg_m2 == pytest.approx(total)
    assert any("improper" in note for note in plant.notes) == (damping == 0.0)


def test_rigid_plant_has_no_resonance() -> None:
    with pytest.raises(BadInputError, match="no resonance"):
        design_plant(Model("rigid", RIGID))


def test_missing_output(paper_model: Model) -> None:
    functions = {k: v for k, v in paper_model.transfer_functions.items() if k != OUTPUTS[1]}
    with pytest.raises(BadInputError, match="no 'wheel_speed_rad_s'"):
        design_plant(replace(paper_model, transfer_functions=functions))


def test_unstable_plant(paper_model: Model) -> None:
    functions = {
        k: TransferFunction(v.numerator, (1.0, -3.0, 200.0, 10.0, 5.0, 0.0), 0.008)
        for k, v in paper_model.transfer_functions.items()
    }
    with pytest.raises(BadInputError, match="unstable"):
        design_plant(replace(paper_model, transfer_functions=functions))


@pytest.mark.parametrize("name", OUTPUTS[:2])
def test_no_inertia_or_ratio_at_low_frequency(paper_model: Model, name: str) -> None:
    broken = replace(
        paper_model.transfer_functions[name],
        numerator=(*paper_model.transfer_functions[name].numerator[:-1], 0.0),
    )
    with pytest.raises(BadInputError, match="at low frequency"):
        design_plant(replace(paper_model, transfer_functions=paper_model.transfer_functions | {name: broken}))
