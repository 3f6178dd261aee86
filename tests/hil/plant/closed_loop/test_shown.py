"""Numbers that cross a wire, rounded without packing them into frames."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.signals import Signal
from hil.plant.closed_loop import rounded


@pytest.mark.parametrize(
    "signal",
    [
        Signal("count", 3, 10, signed=True, scale=0.5),
        Signal("share", 0, 16, scale=1e-3, offset=-7.0),
        Signal("word", 8, 48, big_endian=True, signed=True, scale=1e-5),
        Signal("whole", 0, 64, signed=True),
        Signal("single", 0, 32, is_float=True),
    ],
    ids=lambda signal: signal.name,
)
@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=5))
def test_rounding_is_what_a_frame_does(signal, values):
    framed = signal.decode(signal.encode(values))
    assert np.array_equal(rounded(signal, values), framed)
