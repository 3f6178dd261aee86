from __future__ import annotations

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.analysis.control_design import (
    Normalisation,
    feed_forward,
    lead,
    lead_function,
    notch_function,
    pole_assignment,
    speed_filter,
)
from hil.core.channels import OUTPUTS
from hil.core.controller import Notch
from hil.core.errors import BadInputError
from hil.core.model import Model

FREQUENCY = np.geomspace(0.01, 100, 50)


def test_gains_of_the_paper() -> None:
    """(4)(5) with the inertia that the paper's K_p needs."""
    gain, integral = pole_assignment(4.4625, 0.3)
    assert gain == pytest.approx(2.6775)
    assert integral == pytest.approx(0.4016, abs=5e-5)
    assert pole_assignment(4.4625, -0.3) == (gain, integral)


def test_both_poles_lie_where_they_were_assigned() -> None:
    gain, integral = pole_assignment(4.5, 0.3)
    np.testing.assert_allclose(np.roots([4.5, gain, integral]), [-0.3, -0.3], rtol=1e-6)


def test_lead_of_the_paper() -> None:
    part = lead(36, 40)
    assert part.alpha == pytest.approx(0.25962, abs=5e-6)
    assert part.time_constant_s == pytest.approx(7.8087e-3, abs=4e-7)


@given(
    st.floats(0, 80),
    st.floats(1, 200),
    st.sampled_from(["dc", "centre", "high_frequency"]),
)
def test_lead_turns_by_its_angle_at_its_frequency(
    angle: float, centre: float, normalisation: Normalisation
) -> None:
    part = lead_function(lead(angle, centre, normalisation))
    assert np.degrees(np.angle(part.response(np.array([centre])))[0]) == pytest.approx(angle, abs=1e-6)
    where = {"dc": 1e-9, "centre": centre, "high_frequency": 1e9}[normalisation]
    assert np.abs(part.response(np.array([where])))[0] == pytest.approx(1, rel=1e-6)


@pytest.mark.parametrize(("angle", "centre"), [(-1, 40), (90, 40), (36, 0)])
def test_impossible_lead(angle: float, centre: float) -> None:
    with pytest.raises(BadInputError, match="cannot be made"):
        lead(angle, centre)


def test_notch_is_d_deep_and_one_far_away() -> None:
    part = notch_function(Notch(frequency_hz=10.6, width=2.0, depth=0.08))
    deep, low, high = np.abs(part.response(np.array([10.6, 1e-4, 1e6])))
    assert deep == pytest.approx(0.08)
    assert [low, high] == pytest.approx([1, 1], rel=1e-3)


def test_filters_against_python_control(paper_model: Model) -> None:
    functions = [control.tf(f.numerator, f.denominator) for f in paper_model.transfer_functions.values()]
    motor, wheel, shaft = functions
    low_pass = control.tf([1], [0.05, 1])
    mine = [paper_model.transfer_functions[name] for name in OUTPUTS]
    for found, reference in (
        (speed_filter(mine[0], mine[1], 0.05), motor / wheel * low_pass),
        (feed_forward(mine[2], 0.05), low_pass / shaft),
    ):
        expected = np.array(control.frequency_response(reference, 2 * np.pi * FREQUENCY).frdata)[0, 0]
        np.testing.assert_allclose(found.response(FREQUENCY), expected, rtol=1e-6)


def test_filters_of_the_paper_are_stable_and_proper(paper_model: Model) -> None:
    mine = [paper_model.transfer_functions[name] for name in OUTPUTS]
    for part in (speed_filter(mine[0], mine[1], 0.05), feed_forward(mine[2], 0.05)):
        assert np.all(np.roots(part.denominator).real < 0)
        assert len(part.numerator) <= len(part.denominator)
    ratio = speed_filter(mine[0], mine[1], 0.05).response(np.array([1e-6]))[0]
    assert ratio.real == pytest.approx(8.148, abs=5e-4)
