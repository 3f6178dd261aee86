"""Frames that came damaged: those whose checksum is not that of their content."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from drivers.echoes import least_bytes
from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock, crc8_many
from hil.core.can.signals import FrameLayout

_LAST_BYTE = (56, 8)
_OTHERS = SENT_BY_HOST | EXTENDED | ERROR_FRAME
_FEW = 2  # so many are no reason to doubt a bus


class FrameDamage:
    """Counts the received frames of a bus that carry a checksum, and those whose checksum is wrong.

    Args:
        layouts: frames by their names; those without a checksum in their last byte are not looked at.
    """

    def __init__(self, bus: str, layouts: Mapping[str, FrameLayout]) -> None:
        self._bus = bus
        self._checked = {name: layout for name, layout in layouts.items() if has_checksum(layout)}
        self._came = dict.fromkeys(self._checked, 0)
        self._wrong = dict.fromkeys(self._checked, 0)

    def take(self, block: FrameBlock) -> None:
        """Take the frames of a block of this bus."""
        for name, layout in self._checked.items():
            place = (block["id"] == layout.id) & (block["flags"] & _OTHERS == 0)
            payloads = block["data"][place & (block["length"] >= least_bytes([layout.signals["Crc"]]))]
            if len(payloads):
                right = crc8_many(layout.id, payloads)
                self._came[name] += len(payloads)
                self._wrong[name] += int(np.count_nonzero(payloads >> np.uint64(_LAST_BYTE[0]) != right))

    def __str__(self) -> str:
        found = [
            f"{wrong} of {self._came[name]} frames {name}"
            for name, wrong in self._wrong.items()
            if wrong > _FEW
        ]
        return f"bus '{self._bus}': {', '.join(found)} are damaged (wrong checksum)" if found else ""


def has_checksum(layout: FrameLayout) -> bool:
    """Whether a frame's last byte is a checksum that can be looked at."""
    return "Crc" in layout.signals and layout.signals["Crc"].place[:2] == _LAST_BYTE
