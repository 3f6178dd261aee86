"""How many bits frames take on the wire, stuff bits included: what the load of a bus is made of."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import ERROR_FRAME, EXTENDED, UNSTUFFED, FrameBlock, most_frame_bits
from hil.core.runtime.compiled import compiled

_POLYNOMIAL, _CRC_BITS = 0x4599, 15
_RUN = 5  # after so many equal bits the sender puts one of the other kind


def bits_on_the_wire(block: FrameBlock) -> npt.NDArray[np.int64]:
    """Bits of each frame from its start to the end of the intermission (ISO 11898-1), shape (n,).

    Classic data frames; an error frame counts as none.
    """
    return _bits(  # type: ignore[no-any-return]
        block["id"].astype(np.int64),
        block["flags"].astype(np.int64),
        block["length"].astype(np.int64),
        block["data"].astype(np.uint64),
    )


def most_bits_on_the_wire(block: FrameBlock) -> int:
    """Bits of all frames together with as many stuff bits as they may have: from their lengths alone."""
    return int(_most_bits(block["flags"], block["length"]))


@compiled
def _most_bits(flags, lengths):  # type: ignore[no-untyped-def]
    bits = 0
    for frame in range(flags.shape[0]):
        if flags[frame] & ERROR_FRAME:
            continue
        bits += most_frame_bits(int(lengths[frame]), flags[frame] & EXTENDED != 0)
    return bits


@compiled
def _header(frame_id, extended, length):  # type: ignore[no-untyped-def]
    """From the start of frame to the data length code, and how many bits these are."""
    if extended:
        front = frame_id >> 18 << 2 | 3  # substitute remote request and identifier extension are recessive
        return front << 25 | (frame_id & 0x3FFFF) << 7 | length, 39
    return frame_id << 7 | length, 19


@compiled
def _bits(ids, flags, lengths, payloads):  # type: ignore[no-untyped-def]
    found = np.zeros(ids.shape[0], np.int64)
    for frame in range(ids.shape[0]):
        if flags[frame] & ERROR_FRAME:
            continue
        head, count = _header(ids[frame], flags[frame] & EXTENDED, lengths[frame])
        covered = count + 8 * lengths[frame]
        crc, last, run, stuffed = 0, -1, 0, 0
        for place in range(covered + _CRC_BITS):
            if place < count:
                bit = head >> (count - 1 - place) & 1
            elif place < covered:
                byte, in_byte = divmod(place - count, 8)
                bit = np.int64(payloads[frame] >> np.uint64(8 * byte + 7 - in_byte) & np.uint64(1))
            else:
                bit = crc >> (_CRC_BITS - 1 - (place - covered)) & 1
            if place < covered:
                turned = bit ^ (crc >> (_CRC_BITS - 1) & 1)
                crc = crc << 1 & 0x7FFF
                if turned:
                    crc ^= _POLYNOMIAL
            run = run + 1 if bit == last else 1
            last = bit
            if run == _RUN:
                stuffed += 1
                last, run = 1 - bit, 1
        found[frame] = covered + _CRC_BITS + stuffed + UNSTUFFED
    return found
