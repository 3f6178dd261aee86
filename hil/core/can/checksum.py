"""CRC-8 SAE J1850 of RMCU frames: over the identifier's low byte and the first seven payload bytes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled

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
