"""Symbols laid into packets."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.ram._decoder import bits_of, packed
from hil.core.can.frames import most_frame_bits
from hil.core.can.symbols import Symbol
from hil.core.errors import BenchError

FLOATS = [Symbol(f"f{n}", 0x100 + 4 * n, "f4") for n in range(8)]


def test_eight_floats_take_five_packets() -> None:
    odts = packed(FLOATS, 2, 8, 1, 7)
    assert [sum(entry.size for entry in odt) for odt in odts] == [5, 7, 7, 7, 6]
    assert bits_of(odts, 2) == 4 * most_frame_bits(8, False) + most_frame_bits(7, False)


@given(
    sizes=st.lists(st.sampled_from(["u1", "u2", "f4", "f8"]), min_size=1, max_size=20),
    stamp=st.sampled_from([1, 2, 4]),
    most=st.integers(1, 8),
)
def test_every_byte_stands_once_in_its_order(sizes: list[str], stamp: int, most: int) -> None:
    symbols = [Symbol(f"s{n}", 16 * n, kind) for n, kind in enumerate(sizes)]
    odts = packed(symbols, stamp, 8, 1, most)
    laid = [entry.address + byte for odt in odts for entry in odt for byte in range(entry.size)]
    assert laid == [symbol.address + byte for symbol in symbols for byte in range(symbol.size)]
    room = [8 - 1 - stamp, *[7] * (len(odts) - 1)]
    assert all(sum(e.size for e in odt) <= left for odt, left in zip(odts, room, strict=True))
    assert all(0 < entry.size <= most for odt in odts for entry in odt)


def test_a_slave_that_takes_whole_words_gets_whole_words() -> None:
    odts = packed(FLOATS[:3], 2, 8, 4, 4)
    assert [[entry.size for entry in odt] for odt in odts] == [[4], [4], [4]]
    with pytest.raises(BenchError, match="'b' has 1 bytes; only multiples of 4"):
        packed([Symbol("b", 0, "u1")], 2, 8, 4, 4)


def test_more_than_can_be_numbered_is_refused() -> None:
    with pytest.raises(BenchError, match="omit symbols"):
        packed([Symbol(f"d{n}", 8 * n, "f8") for n in range(300)], 2, 8, 1, 7)
