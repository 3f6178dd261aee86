"""CRC-8 SAE J1850 of RMCU frames: over the identifier's low byte and the first seven payload bytes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.compiled import compiled

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
    return np.asarray(_crc_of_each(frame_id, payloads, _ARRAY))


@compiled
def _crc_of_each(frame_id, payloads, table):  # type: ignore[no-untyped-def]
    found = np.empty(payloads.shape[0], np.uint64)
    for i in range(payloads.shape[0]):
        crc = table[_START ^ (frame_id & 0xFF)]
        word = payloads[i]
        for _ in range(7):
            crc = table[crc ^ np.uint8(word & np.uint64(0xFF))]
            word >>= np.uint64(8)
        found[i] = crc ^ np.uint8(_FINAL)
    return found
