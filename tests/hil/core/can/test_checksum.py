import numpy as np
from crccheck.crc import Crc8SaeJ1850
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.frames import crc8, crc8_many


@given(st.integers(0, 0x7FF), st.integers(0, 2**64 - 1))
def test_agrees_with_crccheck(frame_id, payload):
    octets = bytes([frame_id & 0xFF]) + payload.to_bytes(8, "little")[:7]
    assert crc8(frame_id, payload) == Crc8SaeJ1850.calc(octets)


@given(st.integers(0, 0x7FF), st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=5))
def test_many_is_one_for_each(frame_id, payloads):
    many = crc8_many(frame_id, np.array(payloads, np.uint64))
    assert many.tolist() == [crc8(frame_id, payload) for payload in payloads]
