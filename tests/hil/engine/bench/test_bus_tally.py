"""Frames of a bus, counted."""

import numpy as np
import pytest

from hil.core.can.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST
from hil.engine.bench.bus_tally import Tally, known_identifiers
from tests.benches_for_tests import SIM

FRAMES = [
    (0.0, 0x110, 0, 8, 0x5555555555555555),
    (0.1, 0x110, 0, 8, 0x5555555555555555),
    (0.2, 0x110, EXTENDED, 8, 0),
    (0.3, 0x100, SENT_BY_HOST, 8, 0),
    (0.4, 0x004, EXTENDED | ERROR_FRAME, 8, 0),
    (0.5, 0x3A0, 0, 2, 0),
]


def test_frames_of_others_are_counted_by_identifier_and_kind():
    tally = Tally()
    tally.take(np.array(FRAMES, FRAME))
    assert (tally.frames, tally.errors) == (4, 1)
    assert tally.standard_ids == {0x110, 0x3A0}
    assert tally.unknown({0x110}, 2.0) == {"0x00000110": 0.5, "0x3A0": 0.5}


def test_what_the_host_sends_takes_room_too():
    alone, both = Tally(), Tally()
    alone.take(np.array(FRAMES[:1], FRAME))
    both.take(np.array([FRAMES[0], FRAMES[3]], FRAME))
    assert 111 <= alone.load(1, 1.0) < both.load(1, 1.0)
    assert alone.load(1_000_000, 0.001) == pytest.approx(0.12, abs=0.02)


def test_a_bench_file_knows_what_its_devices_send_and_hear():
    assert {0x100, 0x110, 0x111, 0x112, 0x200} <= known_identifiers(SIM, "rmcu")
    assert {0x080, 0x183, 0x704, 0x701, 0x77F} <= known_identifiers(SIM, "dyno")
    assert 0x110 not in known_identifiers(SIM, "dyno")
