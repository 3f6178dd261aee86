"""Bits of frames on the wire, against the same written down bit by bit as the standard has it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers import bits_on_the_wire, most_bits_on_the_wire
from hil.core.can.frames import ERROR_FRAME, EXTENDED, FRAME


def written_down(frame_id, extended, data):
    """ISO 11898-1, as text of zeros and ones."""
    if extended:
        head = f"0{frame_id >> 18:011b}11{frame_id & 0x3FFFF:018b}000{len(data):04b}"
    else:
        head = f"0{frame_id:011b}000{len(data):04b}"
    covered = head + "".join(f"{byte:08b}" for byte in data)
    remainder = int(covered + "0" * 15, 2)
    divisor = 0b1100010110011001
    for shift in range(len(covered) - 1, -1, -1):
        if remainder >> (shift + 15) & 1:
            remainder ^= divisor << shift
    bits, stuffed = covered + f"{remainder:015b}", ""
    for bit in bits:
        stuffed += bit
        if stuffed[-5:] in ("00000", "11111") and (len(stuffed) == 5 or _is_run(stuffed)):
            stuffed += "10"[int(bit)]
    return len(stuffed) + 13


def _is_run(text):
    """Whether the last five equal bits are a whole run, or its multiple, since the last other bit."""
    last = text[-1]
    length = len(text) - len(text.rstrip(last))
    return length == 5


@given(
    extended=st.booleans(),
    number=st.integers(0, 2**29 - 1),
    data=st.binary(max_size=8),
)
def test_bits_are_those_of_the_standard(extended, number, data):
    number = number if extended else number % 2048
    frame = (0.0, number, EXTENDED * extended, len(data), int.from_bytes(data, "little"))
    written = written_down(number, extended, data)
    assert bits_on_the_wire(np.array([frame], FRAME)).tolist() == [written]
    most = most_bits_on_the_wire(np.array([frame], FRAME))
    assert written <= most <= 1.27 * written


def test_lengths_without_and_with_the_most_stuffing():
    frames = np.array([(0, 0x555, 0, 8, 0x5555555555555555), (0, 0, 0, 8, 0)], FRAME)
    alternating, zeros = bits_on_the_wire(frames)
    assert 111 <= alternating < zeros <= 135
    assert most_bits_on_the_wire(frames) == 270


def test_an_error_frame_is_none():
    assert bits_on_the_wire(np.array([(0, 4, ERROR_FRAME, 8, 0)], FRAME)).tolist() == [0]
    assert most_bits_on_the_wire(np.array([(0, 4, ERROR_FRAME, 8, 0)], FRAME)) == 0


@pytest.mark.parametrize("length", range(9))
def test_no_frame_is_shorter_than_its_bits_without_stuffing(length):
    frames = np.zeros(500, FRAME)
    random = np.random.default_rng(length)
    frames["id"], frames["length"] = random.integers(0, 2048, 500), length
    frames["data"] = random.integers(0, 2**63, 500) & (2 ** (8 * length) - 1 if length < 8 else 2**63 - 1)
    bits = bits_on_the_wire(frames)
    assert bits.min() >= 47 + 8 * length
    assert bits.max() <= 47 + 8 * length + (33 + 8 * length) // 4
