"""Frames in datagrams: nothing is lost unseen, nothing strange is taken, nothing leaves the machine."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.frames import FRAME
from sim_backend.datagrams import Incoming, Kind, Outgoing, Welcome, address_of, kind_of, signal, welcome_of


def frames(count, first=0):
    block = np.zeros(count, FRAME)
    block["id"] = first + np.arange(count)
    block["time_s"] = 1.7e9 + 0.001 * np.arange(count)
    block["length"], block["data"] = 8, 2**64 - 1
    return block


def test_frames_arrive_as_they_were_sent():
    outgoing, incoming = Outgoing(), Incoming()
    sent = frames(2500)
    datagrams = outgoing.packed(sent)
    assert all(kind_of(datagram) is Kind.FRAMES for datagram in datagrams)
    assert max(map(len, datagrams)) < 1 << 16
    received = np.concatenate([incoming.frames(datagram) for datagram in datagrams])
    np.testing.assert_array_equal(received, sent)
    assert incoming.lost == 0


@given(st.lists(st.integers(1, 40), min_size=2, max_size=20), st.data())
def test_lost_frames_are_counted_and_late_ones_are_not_taken_twice(counts, data):
    outgoing, incoming = Outgoing(), Incoming()
    datagrams = [outgoing.packed(frames(count))[0] for count in counts]
    # What is missing before the first or behind the last cannot be known
    missing = data.draw(st.sets(st.integers(1, len(counts) - 1), max_size=len(counts) - 2))
    missing.discard(len(counts) - 1)
    for number, datagram in enumerate(datagrams):
        if number not in missing:
            assert len(incoming.frames(datagram)) == counts[number]
    assert incoming.lost == sum(counts[number] for number in missing)
    assert len(incoming.frames(datagrams[0])) == 0


def test_the_count_goes_round():
    outgoing, incoming = Outgoing(), Incoming()
    outgoing._next = 2**32 - 3
    for _ in range(3):
        (datagram,) = outgoing.packed(frames(2))
        assert len(incoming.frames(datagram)) == 2
    assert incoming.lost == 0


@pytest.mark.parametrize(
    "datagram",
    [b"", b"HILB", b"x" * 40, signal(Kind.HELLO)[:-1], Outgoing().packed(frames(2))[0][:-1],
     signal(Kind.WELCOME), b"HILB\x02\x01" + bytes(6), b"HILB\x01\x09" + bytes(6)],
)  # fmt: skip
def test_what_is_none_of_ours_is_none(datagram):
    assert kind_of(datagram) is None


def test_a_welcome_says_what_the_bus_is():
    datagram = Welcome(500_000, 0.2).packed()
    assert kind_of(datagram) is Kind.WELCOME
    assert welcome_of(datagram) == Welcome(500_000, 0.2)


@pytest.mark.parametrize("channel", ["127.0.0.1:5000", "localhost:5000", "127.0.0.7:5000"])
def test_addresses_of_this_machine_are_taken(channel):
    assert address_of(channel)[1] == 5000


@pytest.mark.parametrize(
    "channel",
    ["192.168.0.1:5000", "0.0.0.0:5000", "239.1.2.3:5000", "example.org:5000", "127.0.0.1", "127.0.0.1:0",
     "127.0.0.1:99999", "127.0.0.1:x", "::1:5000", ":5000", "0"],
)  # fmt: skip
def test_nothing_beyond_this_machine_is_spoken_to(channel):
    with pytest.raises(ValueError, match=r"write \"127.0.0.1:47110\""):
        address_of(channel)
