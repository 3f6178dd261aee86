from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from hil.analysis.control_design import feed_forward, feedback_response, lead, lead_function, tustin
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction


@given(st.floats(1, 70), st.floats(5, 100))
def test_against_scipy(angle: float, centre: float) -> None:
    part = lead_function(lead(angle, centre))
    found = tustin(part, 0.001)
    b, a, _ = signal.cont2discrete((np.array(part.numerator), np.array(part.denominator)), 0.001, "bilinear")
    np.testing.assert_allclose(found.b, b.ravel(), rtol=1e-9)
    np.testing.assert_allclose(found.a, a, rtol=1e-9)


def test_low_frequencies_are_the_continuous_ones(paper_model: Model) -> None:
    part = feed_forward(paper_model.transfer_functions["shaft_torque_nm"], 0.05)
    found = tustin(part, 0.001)
    assert found.stable
    frequency = np.geomspace(0.05, 30, 40)
    # Tustin's frequency warping is (ω T)²/12, 0.3 % at 30 Hz.
    np.testing.assert_allclose(found.response(frequency), part.response(frequency), rtol=0.02)


def test_improper_functions_are_refused() -> None:
    with pytest.raises(BadInputError, match="improper"):
        tustin(TransferFunction((1.0, 0.0, 0.0), (1.0, 1.0)), 0.001)


def test_loops_are_judged_with_the_same_filters() -> None:
    part = lead_function(lead(36, 40))
    frequency = np.geomspace(0.1, 490, 50)
    found = feedback_response((part,), frequency, 0.001)
    np.testing.assert_allclose(found, tustin(part, 0.001).response(frequency), rtol=1e-9)
