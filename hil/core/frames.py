"""A block of CAN frames as one numpy array: nothing is done per frame that can be done per block."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

#: time_s: seconds on the bench clock · id: CAN identifier · flags: see below · length: bytes used of data
#: data: the payload as a little-endian 64-bit number (byte 0 of the frame is the lowest)
FRAME = np.dtype([("time_s", "<f8"), ("id", "<u4"), ("flags", "u1"), ("length", "u1"), ("data", "<u8")])

EXTENDED = 1
SENT_BY_HOST = 2
ERROR_FRAME = 4

FrameBlock = npt.NDArray[np.void]


def empty_block() -> FrameBlock:
    """A block without frames."""
    return np.zeros(0, FRAME)


def joined(blocks: list[FrameBlock]) -> FrameBlock:
    """The blocks one after the other. As plain bytes: numpy compares structured types field by field."""
    if len(blocks) == 1:
        return blocks[0]
    return np.frombuffer(bytearray().join([block.tobytes() for block in blocks]), FRAME)


def standard(block: FrameBlock) -> FrameBlock:
    """The data frames with an 11-bit identifier: an extended one of the same number is another message."""
    other = block["flags"] & (EXTENDED | ERROR_FRAME)
    return block[other == 0] if np.count_nonzero(other) else block


def newest(block: FrameBlock, frame_id: int) -> tuple[float, int] | None:
    """Time and payload of the last received frame with this identifier; None if the block has none."""
    return newest_of(block, (frame_id,))[0]


def newest_of(block: FrameBlock, frame_ids: tuple[int, ...]) -> list[tuple[float, int] | None]:
    """Time and payload of the last received frame with each of these identifiers; else None."""
    ids, flags = block["id"].tolist(), block["flags"]
    found: list[tuple[float, int] | None] = []
    for frame_id in frame_ids:
        found.append(None)
        for index in range(len(ids) - 1, -1, -1):
            if ids[index] == frame_id and not flags[index] & (SENT_BY_HOST | EXTENDED | ERROR_FRAME):
                found[-1] = float(block["time_s"][index]), int(block["data"][index])
                break
    return found
