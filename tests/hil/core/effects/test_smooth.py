"""Smooth functions that laws share."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.effects._smooth import tanh


@pytest.mark.parametrize("u", [0.0, 1e-9, 0.1, -0.3, 0.499999, 0.500001, -3.0, 19.9, 20.1, 1e6, -math.inf])
def test_the_short_way_to_tanh(u):
    assert tanh(u) == pytest.approx(math.tanh(u), rel=1e-10)


@given(st.floats(allow_nan=False))
def test_however_large_the_argument(u):
    assert tanh(u) == pytest.approx(math.tanh(u), rel=1e-10, abs=1e-300)
