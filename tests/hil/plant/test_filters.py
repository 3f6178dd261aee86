"""Tustin's rule as the RMCU applies it."""

import numpy as np
import pytest
from scipy import signal

from hil.plant.controller.filters import discretised


@pytest.mark.parametrize("order", range(9))
def test_coefficients_are_those_of_scipy(order):
    random = np.random.default_rng(order)
    below = random.normal(size=order + 1)
    for length in range(1, order + 2):
        above = random.normal(size=length) * 1e6 ** (
            order + 1 - length
        )  # else scipy takes the first for zero
        b, a = signal.bilinear(above, below, 1000.0)
        found_b, found_a = discretised(above, below, 0.001)
        assert np.array_equal(found_b, b / a[0])
        assert np.array_equal(found_a, a / a[0])


def test_small_first_coefficients_are_kept_in_their_places():
    b, _ = discretised([1e-13], [1.0, 1.0, 1.0], 0.001)
    assert b == pytest.approx(np.array([1.0, 2.0, 1.0]) * b[0])
    assert b[0] == pytest.approx(1e-13 / 4e6, rel=1e-2)
