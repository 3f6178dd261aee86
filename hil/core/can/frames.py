"""CAN frames as one numpy array a block, and their checksum: CRC-8 SAE J1850 of RMCU frames.

Nothing is done per frame that can be done per block. The checksum covers the identifier's low byte and
the first seven payload bytes.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled

#: time_s: seconds on the bench clock · id: CAN identifier · flags: see below · length: bytes used of data
#: data: the payload as a little-endian 64-bit number (byte 0 of the frame is the lowest)
FRAME = np.dtype([("time_s", "<f8"), ("id", "<u4"), ("flags", "u1"), ("length", "u1"), ("data", "<u8")])

_OPAQUE = np.dtype((np.void, FRAME.itemsize))  # numpy takes structured values out field by field

EXTENDED = 1
SENT_BY_HOST = 2
ERROR_FRAME = 4

FrameBlock = npt.NDArray[np.void]

_HEAD_BITS, _EXTENDED_HEAD_BITS = 34, 54  # with the checksum; stuff bits stand among them and the data
UNSTUFFED = 13  # CRC delimiter, acknowledge slot and delimiter, end of frame (7), intermission (3)
_BETWEEN_STUFF_BITS = 4  # one behind five equal bits, which may begin the next five


def empty_block() -> FrameBlock:
    """A block without frames."""
    return np.zeros(0, FRAME)


def joined(blocks: list[FrameBlock]) -> FrameBlock:
    """The blocks one after the other. As plain bytes: numpy compares structured types field by field."""
    if len(blocks) == 1:
        return blocks[0]
    return np.frombuffer(bytearray().join([block.tobytes() for block in blocks]), FRAME)


def frames(
    frame_id: int,
    payloads: int | npt.NDArray[np.uint64],
    length: int,
    times_s: float | npt.NDArray[np.float64],
    *,
    flags: int = 0,
) -> FrameBlock:
    """Frames of one identifier, each with its payload and time (s); of one length."""
    block = np.empty(np.size(payloads), FRAME)
    block["time_s"], block["data"] = times_s, payloads
    block["id"], block["flags"], block["length"] = frame_id, flags, length
    return block


@compiled
def most_frame_bits(length, extended):  # type: ignore[no-untyped-def]
    """Bits of a data frame of `length` bytes with as many stuff bits as it may have (ISO 11898-1)."""
    stuffable = (_EXTENDED_HEAD_BITS if extended else _HEAD_BITS) + 8 * length
    return stuffable + (stuffable - 1) // _BETWEEN_STUFF_BITS + UNSTUFFED


def longest_frame_s(length: int, bit_rate: int) -> float:
    """Longest time in s of a standard data frame of `length` bytes on a bus of `bit_rate` bit/s."""
    return float(most_frame_bits(length, False)) / bit_rate


def inserted(sent: FrameBlock, came: FrameBlock) -> FrameBlock:
    """Frames that came, in the order in which they came, and between them those sent, by their time.

    A frame that was sent stands before the first one that, by its stamp or that of one before it, was later.
    """
    order = np.empty(len(sent) + len(came), np.int64)
    _merge(sent["time_s"], came["time_s"], order)
    both = np.frombuffer(sent.tobytes() + came.tobytes(), _OPAQUE)
    return np.ndarray(len(order), FRAME, both.take(order))


@compiled
def _merge(sent_s, came_s, order):  # type: ignore[no-untyped-def]
    latest_s, done = -np.inf, 0
    for place in range(len(came_s)):
        latest_s = max(latest_s, came_s[place])
        while done < len(sent_s) and sent_s[done] <= latest_s:
            order[place + done] = done
            done += 1
        order[place + done] = len(sent_s) + place
    for rest in range(done, len(sent_s)):
        order[len(came_s) + rest] = rest


def standard(block: FrameBlock) -> FrameBlock:
    """The data frames with an 11-bit identifier: an extended one of the same number is another message."""
    other = block["flags"] & (EXTENDED | ERROR_FRAME)
    return block[other == 0] if np.count_nonzero(other) else block


_POLYNOMIAL, _START, _FINAL = 0x1D, 0xFF, 0xFF


def _table() -> list[int]:
    table = []
    for value in range(256):
        crc = value
        for _ in range(8):
            crc = (crc << 1 ^ _POLYNOMIAL if crc & 0x80 else crc << 1) & 0xFF
        table.append(crc)
    return table


_TABLE = _table()
_ARRAY = np.array(_TABLE, np.uint8)


def crc8(frame_id: int, payload: int) -> int:
    """Checksum of one payload (byte 0 lowest); its byte 7 is not read."""
    crc = _TABLE[_START ^ (frame_id & 0xFF)]
    for byte in payload.to_bytes(8, "little")[:7]:
        crc = _TABLE[crc ^ byte]
    return crc ^ _FINAL


def crc8_many(frame_id: int, payloads: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """`crc8` of many payloads."""
    return np.asarray(_crc_of_each(frame_id, payloads))


@compiled
def crc8_of(frame_id, payload):  # type: ignore[no-untyped-def]
    """`crc8`, for compiled code."""
    crc = _ARRAY[_START ^ (frame_id & 0xFF)]
    word = np.uint64(payload)
    for _ in range(7):
        crc = _ARRAY[crc ^ np.uint8(word & np.uint64(0xFF))]
        word >>= np.uint64(8)
    return np.uint64(crc ^ np.uint8(_FINAL))


@compiled
def _crc_of_each(frame_id, payloads):  # type: ignore[no-untyped-def]
    found = np.empty(payloads.shape[0], np.uint64)
    for i in range(payloads.shape[0]):
        found[i] = crc8_of(frame_id, payloads[i])
    return found
