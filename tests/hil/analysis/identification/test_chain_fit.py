from __future__ import annotations

import pytest

from hil.analysis.frequency_response import FrequencyResponse
from hil.analysis.identification import Identification, chain_response, choose_chain, fit_chain
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from tests.hil.analysis.conftest import GRID, exact, outputs_of
from tests.hil.analysis.identification.chains import RIGID, THREE, TWO


def test_two_inertias_do_not_do_and_three_do(exact_frf: FrequencyResponse) -> None:
    """Figures of an independent fit: 0.6/0.7/1.1 dB and 3/5/8 degrees; two: 5.9/16.5/4.7, 22/75/8."""
    choice = choose_chain(exact_frf, torque_delay_s=0.008)
    rigid, two, three = choice.fits
    assert choice.best is three
    assert [rigid.explains, two.explains, three.explains] == [False, False, True]
    gains = [three.misfit[name].gain_db for name in OUTPUTS]
    assert gains == pytest.approx([0.6, 0.7, 1.1], abs=0.2)
    assert [three.misfit[name].phase_deg for name in OUTPUTS] == pytest.approx([3, 5, 8], abs=1.2)
    assert [two.misfit[name].gain_db for name in OUTPUTS] == pytest.approx([5.9, 16.5, 4.7], abs=1.5)


def test_values_of_the_papers_chain(exact_frf: FrequencyResponse) -> None:
    values = fit_chain(exact_frf, "three_inertia", torque_delay_s=0.008).model.parameters
    for name, expected in (THREE | {"gear_ratio": 8.33}).items():
        assert values[name] == pytest.approx(expected, rel=0.05), name


def test_from_noisy_data_too(paper_identification: Identification) -> None:
    assert paper_identification.chain is not None
    assert paper_identification.chain.best.model.kind == "three_inertia"
    assert paper_identification.physical is not None


@pytest.mark.parametrize(
    ("kind", "values"), [("rigid", RIGID), ("two_inertia", TWO), ("three_inertia", THREE)]
)
def test_the_chain_that_made_the_data_is_found(kind: str, values: dict[str, float]) -> None:
    choice = choose_chain(exact(chain_response(kind, values, GRID), 0.01))
    assert choice.best.model.kind == kind
    for name, value in values.items():
        error = choice.best.standard_errors[name]
        if kind == "rigid" and name in ("motor_inertia",):
            continue  # only the sum of the inertias acts on the speeds
        assert abs(choice.best.model.parameters[name] - value) < max(5 * error, 1e-3 * value), name


def test_known_gear_ratio_is_kept(exact_frf: FrequencyResponse) -> None:
    found = fit_chain(exact_frf, "three_inertia", gear_ratio=8.148)
    assert found.model.parameters["gear_ratio"] == 8.148
    assert "gear_ratio" not in found.standard_errors


def test_motor_speed_alone_is_not_enough(exact_frf: FrequencyResponse) -> None:
    with pytest.raises(BadInputError, match="another output"):
        fit_chain(outputs_of(exact_frf, 1), "two_inertia")
