"""Smooth functions that laws share."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.effects._smooth import sine, tanh


@pytest.mark.parametrize("u", [0.0, 1e-9, 0.1, -0.3, 0.499999, 0.500001, -3.0, 19.9, 20.1, 1e6, -math.inf])
def test_the_short_way_to_tanh(u):
    assert tanh(u) == pytest.approx(math.tanh(u), rel=1e-10)


@given(st.floats(allow_nan=False))
def test_however_large_the_argument(u):
    assert tanh(u) == pytest.approx(math.tanh(u), rel=1e-10, abs=1e-300)


@given(st.floats(-1e7, 1e7))
def test_the_short_way_to_a_sine(u):
    assert sine(u) == pytest.approx(math.sin(u), abs=1e-14 + 4e-16 * abs(u))


@pytest.mark.parametrize("half_turns", [0, 1, 2, 5, -1, -4, 300_000])
def test_where_a_sine_passes_from_one_half_turn_to_the_next(half_turns):
    for near in (-0.5, 0.0, 0.5):
        u = (half_turns + near) * math.pi
        for one in (math.nextafter(u, -math.inf), u, math.nextafter(u, math.inf)):
            assert sine(one) == pytest.approx(math.sin(one), abs=1e-14 + 4e-16 * abs(u))
