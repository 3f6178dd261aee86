"""A CAN bus as an slcan adapter at a pseudo-terminal: what a USB adapter is to the host that opens it."""

from __future__ import annotations

import contextlib
import os
from typing import Any

import numpy as np

from hil.core.can.frames import EXTENDED, FrameBlock

_BELL, _OK = b"\a", b"\r"
_MOST_WAITING = 1 << 18  # bytes; some seconds of a full bus
_READ = 65536
_LONGEST_LINE = 200
_BIT_RATES = {"S0": 10_000, "S1": 20_000, "S2": 50_000, "S3": 100_000, "S4": 125_000, "S5": 250_000,
              "S6": 500_000, "S7": 800_000, "S8": 1_000_000}  # fmt: skip
_NEAR = 0.1  # S7 is 800 kbit/s for some and 750 for others


class SlcanPort:
    """One bus; one host opens the terminal. Without the bench's bit rate nothing passes, as on any bus.

    slcan has no numbers: what the terminal does not take is counted as lost here.

    Raises:
        OSError: there are no pseudo-terminals here.
    """

    def __init__(self, bit_rate: int) -> None:
        import pty  # here: Windows has none
        import tty

        self._ours, self._theirs = pty.openpty()
        tty.setraw(self._theirs)  # or it would echo what it is sent
        os.set_blocking(self._ours, False)
        self._bit_rate, self._set_rate = bit_rate, 0
        self._open = False
        self._heard, self._waiting = b"", b""
        self.lost = 0

    @property
    def table(self) -> dict[str, Any]:
        """What a bench file says to reach it."""
        return {
            "interface": "slcan",
            "channel": os.ttyname(self._theirs),
            "options": {"sleep_after_open": 0.0},
        }

    def take(self) -> list[tuple[float | None, int, bytes]]:
        """Frames of the host since the last call: identifier and data; when they were sent does not pass."""
        with contextlib.suppress(BlockingIOError):
            while data := os.read(self._ours, _READ):
                self._heard += data
        *lines, self._heard = self._heard.split(_OK)
        self._heard = self._heard[-_LONGEST_LINE:]
        obeyed = [self._obey(line.decode("ascii", "replace")) for line in lines]
        return [(None, *frame) for frame in obeyed if frame is not None]

    def give(self, block: FrameBlock) -> None:
        """Frames of the bench to the host; their stamps do not pass."""
        if self._open and self._hears:
            self._put(_lines(block), len(block))

    def say(self, line: str) -> None:
        """Any line to the host, such as a state of the bus."""
        self._put(line.encode() + _OK, 0)

    def close(self) -> None:
        """Be unplugged."""
        for end in (self._ours, self._theirs):
            os.close(end)

    @property
    def _hears(self) -> bool:
        return abs(self._set_rate / self._bit_rate - 1.0) < _NEAR

    def _obey(self, line: str) -> tuple[int, bytes] | None:
        """Do what a line says; its frame, if it is one that reaches the bench."""
        command = line[:1]
        if command in ("t", "T", "r", "R"):
            frame = _frame(line) if self._open else None
            self._put(_BELL if frame is None and command in "tT" else b"z" + _OK, 0)
            return frame if command == "t" and self._hears else None
        if command in ("O", "L", "C"):
            self._open = command != "C"
        elif line in _BIT_RATES and not self._open:
            self._set_rate = _BIT_RATES[line]
        elif command == "V":
            self._put(b"V1013", 0)
        elif command == "N":
            self._put(b"NSIM1", 0)
        elif line:
            self._put(_BELL, 0)
            return None
        self._put(_OK, 0)
        return None

    def _put(self, data: bytes, frames: int) -> None:
        if len(self._waiting) > _MOST_WAITING:
            self.lost += frames
            return
        self._waiting += data
        with contextlib.suppress(BlockingIOError):
            self._waiting = self._waiting[os.write(self._ours, self._waiting) :]


def _frame(line: str) -> tuple[int, bytes] | None:
    digits = 3 if line[0] == "t" else 8
    try:
        length = int(line[1 + digits])
        data = bytes.fromhex(line[2 + digits :])
        identifier = int(line[1 : 1 + digits], 16)
    except (ValueError, IndexError):
        return None
    return (identifier, data) if len(data) == length else None


def _lines(block: np.ndarray[Any, Any]) -> bytes:
    columns = (block[name].tolist() for name in ("id", "flags", "length", "data"))
    return b"".join(
        b"%c%0*X%d%s\r"
        % (
            b"T" if flags & EXTENDED else b"t",
            8 if flags & EXTENDED else 3,
            identifier,
            length,
            data.to_bytes(8, "little")[:length].hex().upper().encode(),
        )
        for identifier, flags, length, data in zip(*columns, strict=True)
    )
