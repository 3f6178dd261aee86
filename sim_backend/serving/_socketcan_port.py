"""A CAN bus at a SocketCAN interface: on real or emulated controllers, or on vcan."""

from __future__ import annotations

import socket
import struct
from collections import deque
from typing import Any

import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, FrameBlock

_FRAME = struct.Struct("=IB3x8s")  # linux/can.h: struct can_frame
_STAMP = struct.Struct("=qq")  # struct timespec
_TIMESTAMPNS = 35  # SO_TIMESTAMPNS of Linux, which Python does not name
_FLAGS = 0xE0000000  # extended, remote, error
_EXTENDED = 0x80000000
_BUFFER_BYTES = 8 << 20
_RCVBUFFORCE = 33
_MOST_WAITING = 20_000  # frames; some seconds of a busy bus


class SocketcanPort:
    """One bus; hosts are whoever is on it with another interface, or another socket of the same vcan.

    What the controller's queue does not take waits here, for some seconds of a busy bus; the rest is lost.

    Args:
        interface: of the bench.
        hosts: what hosts open: another controller on the same bus, or the same vcan.
        bit_rate: for the bench file; Linux has set the controller's.

    Raises:
        OSError: there is no SocketCAN here, or no such interface.
    """

    def __init__(self, interface: str, hosts: str, bit_rate: int) -> None:
        if not hasattr(socket, "AF_CAN"):
            raise OSError(None, "this system has no SocketCAN")
        self._hosts, self._bit_rate = hosts, bit_rate
        self._socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        try:
            self._socket.bind((interface,))
            self._socket.setsockopt(socket.SOL_SOCKET, _TIMESTAMPNS, 1)
            self._enlarge()
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)
        self._waiting: deque[bytes] = deque()
        self.lost = 0

    @property
    def table(self) -> dict[str, Any]:
        """What a bench file says to reach it."""
        return {"interface": "socketcan", "channel": self._hosts}

    def take(self) -> list[tuple[float | None, int, bytes]]:
        """Standard data frames of hosts since the last call: when the kernel saw them, identifier, data."""
        self._send_waiting()
        frames: list[tuple[float | None, int, bytes]] = []
        while True:
            try:
                raw, ancillary, _, _ = self._socket.recvmsg(_FRAME.size, 64)
            except BlockingIOError:
                return frames
            except OSError:  # a network that is down: hosts see that themselves
                return frames
            identifier, length, data = _FRAME.unpack(raw)
            if not identifier & _FLAGS:
                frames.append((_stamp(ancillary), identifier, data[:length]))

    def give(self, block: FrameBlock) -> None:
        """Frames of the bench."""
        for identifier, flags, length, data in zip(
            block["id"].tolist(),
            block["flags"].tolist(),
            block["length"].tolist(),
            np.ascontiguousarray(block["data"], "<u8").tolist(),
            strict=True,
        ):
            if flags & ERROR_FRAME:
                continue
            marked = identifier | (_EXTENDED if flags & EXTENDED else 0)
            self._waiting.append(_FRAME.pack(marked, length, data.to_bytes(8, "little")))
        while len(self._waiting) > _MOST_WAITING:
            self._waiting.popleft()
            self.lost += 1
        self._send_waiting()

    def close(self) -> None:
        """Leave the bus."""
        self._socket.close()

    def _send_waiting(self) -> None:
        while self._waiting:
            try:
                self._socket.send(self._waiting[0])
            except OSError:  # its queue is full, or the network is down: the next turn tries again
                return
            self._waiting.popleft()

    def _enlarge(self) -> None:
        for option in (_RCVBUFFORCE, socket.SO_RCVBUF):
            try:
                self._socket.setsockopt(socket.SOL_SOCKET, option, _BUFFER_BYTES)
                return
            except PermissionError:
                continue


def _stamp(ancillary: list[tuple[int, int, bytes]]) -> float | None:
    for level, kind, data in ancillary:
        if (level, kind) == (socket.SOL_SOCKET, _TIMESTAMPNS) and len(data) >= _STAMP.size:
            seconds, nanoseconds = _STAMP.unpack_from(data)
            return float(seconds + 1e-9 * nanoseconds)
    return None
