"""CRC-8 SAE J1850 of RMCU frames: over the identifier's low byte and the first seven payload bytes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

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
    for _ in range(7):
        crc = _TABLE[crc ^ (payload & 0xFF)]
        payload >>= 8
    return crc ^ _FINAL


def crc8_many(frame_id: int, payloads: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """`crc8` of many payloads."""
    octets = np.ascontiguousarray(payloads, "<u8").view(np.uint8).reshape(-1, 8)
    crc = np.full(len(octets), _TABLE[_START ^ (frame_id & 0xFF)], np.uint8)
    for column in range(7):
        crc = _ARRAY[crc ^ octets[:, column]]
    return (crc ^ np.uint8(_FINAL)).astype(np.uint64)
