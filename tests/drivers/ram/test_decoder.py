"""Packets of measured data as an adapter hands them over: split, lost, twice, foreign ones between them."""

from __future__ import annotations

import numpy as np
import pytest

from drivers.ram._decoder import DaqDecoder, packed
from hil.core.can.frames import FRAME, FrameBlock
from hil.core.can.symbols import Symbol
from hil.core.can.xcp import TimeStamps

SYMBOLS = [Symbol("a", 0, "f4"), Symbol("b", 4, "i2", "", 0.5, 1.0), Symbol("c", 6, "f8")]
STAMPS = TimeStamps(2, 1e-4, False)
FIRST = 3


def decoder(order: str = "<", stamps: TimeStamps = STAMPS) -> DaqDecoder:
    return DaqDecoder(FIRST, packed(SYMBOLS, stamps.size, 8, 1, 7), SYMBOLS, stamps, order, 1e-3)


def sent(samples: range, order: str = "<", stamps: TimeStamps = STAMPS) -> FrameBlock:
    """The packets of samples in which a = k, b = 2 k, c = -k."""
    odts = packed(SYMBOLS, stamps.size, 8, 1, 7)
    frames = []
    for k in samples:
        values = np.array([[k], [2 * k], [-k]], float)
        data = b"".join(s.raw(v, order).tobytes() for s, v in zip(SYMBOLS, values, strict=True))
        stamp = (k * 10) % (1 << 8 * stamps.size)
        for number, odt in enumerate(odts):
            size = sum(entry.size for entry in odt)
            head = stamp.to_bytes(stamps.size, "little" if order == "<" else "big") if number == 0 else b""
            packet = bytes([FIRST + number]) + head + data[:size]
            data = data[size:]
            frames.append((1e-3 * k + 1e-4 * number, 0x551, 0, len(packet), int.from_bytes(packet, "little")))
    return np.array(frames, FRAME)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("size", [1, 2, 4])
def test_values_and_counts_come_back(order: str, size: int) -> None:
    stamps = TimeStamps(size, 1e-4, False)
    times, values, counts = decoder(order, stamps).take(sent(range(5, 60), order, stamps))
    k = np.arange(5, 60)
    assert np.array_equal(values, np.column_stack([k, 2 * k, -k]))
    assert np.array_equal(np.diff(counts), np.ones(54))
    assert times == pytest.approx(1e-3 * k)


def test_blocks_may_end_anywhere_and_stamps_begin_again() -> None:
    block, reader = sent(range(13_000)), decoder()  # a turn is 6553.6 samples
    pieces = np.split(block, np.sort(np.random.default_rng(1).integers(0, len(block), 900)))
    found = [reader.take(piece) for piece in pieces if len(piece)]
    assert np.array_equal(np.concatenate([counts for _, _, counts in found]), np.arange(13_000))
    assert np.array_equal(np.concatenate([values[:, 0] for _, values, _ in found]), np.arange(13_000))


def test_a_lost_packet_costs_its_sample_and_no_other() -> None:
    block = sent(range(100))
    _, values, counts = decoder().take(np.delete(block, 3 * 40 + 1))
    assert np.array_equal(counts, np.delete(np.arange(100), 40))
    assert np.array_equal(values[:, 0], counts)


def test_what_comes_twice_or_of_others_is_passed_over() -> None:
    block = np.repeat(sent(range(100)), 2)
    other = block[:1].copy()
    other["data"] = 0x77
    _, values, counts = decoder().take(np.concatenate([other, block, other]))
    assert np.array_equal(values[:, 0], np.arange(100))
    assert np.array_equal(counts, np.arange(100))


def test_packets_that_are_too_short_are_none() -> None:
    block = sent(range(10))
    block["length"][3 * 5 + 2] -= 1
    assert decoder().take(block)[2].tolist() == [0, 1, 2, 3, 4, 6, 7, 8, 9]


def test_stamps_that_stand_still_are_noticed() -> None:
    reader = decoder()
    one = sent(range(7, 8))
    for _ in range(30):
        reader.take(one)
    assert not reader.stands_still
    for _ in range(30):
        reader.take(np.concatenate([one, one]))
    assert reader.stands_still
    reader.take(sent(range(8, 9)))
    assert not reader.stands_still
