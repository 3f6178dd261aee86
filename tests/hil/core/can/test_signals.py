from pathlib import Path

import cantools
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.signals import Signal, layout_of, swapped

DBC = Path(__file__).parents[4] / "benches" / "rmcu.dbc"
DATABASE = cantools.database.load_file(str(DBC))
BIG_ENDIAN = cantools.database.load_string(
    """VERSION ""
BU_: A
BO_ 1 M: 8 A
 SG_ A : 7|16@0+ (0.5,-3) [0|0] "" A
 SG_ B : 23|12@0- (2,0) [0|0] "" A
 SG_ C : 27|4@0+ (1,0) [0|0] "" A
 SG_ D : 32|24@1- (0.001,0) [0|0] "" A
""",
    "dbc",
)
MESSAGES = [*DATABASE.messages, *BIG_ENDIAN.messages]


@pytest.mark.parametrize("message", MESSAGES, ids=lambda m: m.name)
@given(payloads=st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=8))
def test_decoding_agrees_with_cantools_signal_by_signal(message, payloads):
    layout = layout_of(message)
    decoded = layout.decode(np.array(payloads, np.uint64))
    for row, payload in enumerate(payloads):
        expected = message.decode(payload.to_bytes(8, "little"), decode_choices=False)
        for name, value in expected.items():
            assert decoded[name][row] == pytest.approx(value, nan_ok=True)
            assert layout.signals[name].value(payload) == pytest.approx(value, nan_ok=True)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda m: m.name)
@given(payload=st.integers(0, 2**64 - 1))
def test_encoding_is_the_inverse_of_decoding(message, payload):
    for signal in layout_of(message).signals.values():
        value = signal.value(payload)
        if not np.isnan(value):
            assert signal.raw(int(signal.encode(value)[0])) == signal.raw(payload)


@given(st.floats(-1e6, 1e6))
def test_values_beyond_the_range_are_clipped_not_wrapped(value):
    signal = Signal("s", 3, 10, signed=True, scale=0.5)
    low, high = signal.limits
    assert signal.value(int(signal.encode(value)[0])) == pytest.approx(min(max(value, low), high), abs=0.25)


@given(st.integers(0, 2**64 - 1))
def test_swapping_reverses_the_bytes(payload):
    assert int(swapped(np.uint64(payload))) == int.from_bytes(payload.to_bytes(8, "little"), "big")
