"""The frames of the cyclic messages, made for many samples at once, with the times they take on the bus."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.frames import FRAME, FrameBlock
from hil.core.signals import FrameLayout

Payloads = npt.NDArray[np.uint64]


def frame_time_s(length: int, bit_rate: int) -> float:
    """Longest time of a standard data frame on the bus, with stuff bits and interframe space (ISO 11898-1)."""
    bits = 8 * length
    return (bits + 47 + (34 + bits - 1) // 4) / bit_rate


def interleaved(
    start_s: npt.NDArray[np.float64], messages: list[tuple[FrameLayout, Payloads]], bit_rate: int
) -> FrameBlock:
    """One block in the order of the bus: each sample's messages one after the other."""
    block = np.zeros((len(start_s), len(messages)), FRAME)
    busy_s = 0.0
    for column, (layout, payloads) in enumerate(messages):
        busy_s += frame_time_s(layout.length, bit_rate)
        block["time_s"][:, column] = start_s + busy_s
        block["id"][:, column] = layout.id
        block["length"][:, column] = layout.length
        block["data"][:, column] = payloads
    return block.reshape(-1)


def single(frame_id: int, data: bytes, time_s: float) -> FrameBlock:
    """A block of one frame."""
    block = np.zeros(1, FRAME)
    block["time_s"], block["id"], block["length"] = time_s, frame_id, len(data)
    block["data"] = int.from_bytes(data, "little")
    return block
