"""A bus that `hil bench sim` serves, as a python-can interface.

`can.Bus(interface="hil-udp", channel="127.0.0.1:47110")`
"""

from __future__ import annotations

import contextlib
import logging
import select
import socket
import time
from collections import deque
from typing import Any

import can
import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST, FrameBlock, empty_block, joined
from sim_backend.datagrams import (
    LARGEST,
    Incoming,
    Kind,
    Outgoing,
    Welcome,
    address_of,
    kind_of,
    signal,
    welcome_of,
)

_LOG = logging.getLogger(__name__)

_WELCOME_WITHIN_S, _ASK_EVERY_S = 1.0, 0.1
_HELLO_EVERY_S = 0.5
_RECEIVE_BUFFER_BYTES = 4 << 20
_LONGEST_DATA = 8


class LoopbackBus(can.BusABC):
    """One bus of a simulated bench in another process of this machine.

    Frames carry the stamps of the sending side. `lost` counts frames that were sent to this host and never
    came; `time_scale` is what the bench says of itself: seconds of bench time in a second.

    With `receive_own_messages` own frames come back with the time at which they were on the bus.

    Beside python-can's interface it has `recv_epoch_block`, which gives all waiting frames with stamps since
    1970, and `send_frame`, which needs no message object.
    """

    def __init__(
        self, channel: str, bitrate: int | None = None, receive_own_messages: bool = False, **kwargs: Any
    ) -> None:
        self._hello = signal(Kind.ECHO if receive_own_messages else Kind.HELLO)
        try:
            address = address_of(str(channel))
        except ValueError as error:
            raise can.CanInitializationError(str(error)) from None
        self._address = f"{address[0]}:{address[1]}"
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
            self._socket.connect(address)
            self._socket.setblocking(False)
            welcome = self._ask()
            if bitrate is not None and bitrate != welcome.bit_rate:
                raise can.CanInitializationError(
                    f"the bus at {self._address} runs at {welcome.bit_rate} bit/s, not at {bitrate}"
                )
        except BaseException:
            self._socket.close()
            raise
        self.time_scale = welcome.time_scale
        self._incoming, self._outgoing = Incoming(), Outgoing()
        self._waiting: deque[can.Message] = deque()
        self._hello_s = time.monotonic()
        self._told = 0
        self.channel_info = f"simulated bench at {self._address}"
        super().__init__(channel=channel, **kwargs)

    @property
    def lost(self) -> int:
        """Frames that were sent to this host and never came."""
        return self._incoming.lost

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Put a frame on the bus."""
        del timeout
        self.send_frame(msg.arbitration_id, bytes(msg.data), EXTENDED * msg.is_extended_id)

    def send_frame(self, frame_id: int, data: bytes, flags: int = 0) -> None:
        """Put a data frame on the bus.

        Raises:
            CanOperationError: no one serves the bus any more, or the frame is one of CAN FD.
        """
        if len(data) > _LONGEST_DATA:
            raise can.CanOperationError(f"a frame has at most {_LONGEST_DATA} bytes here, not {len(data)}")
        frame = np.array([(time.time(), frame_id, flags, len(data), int.from_bytes(data, "little"))], FRAME)
        for datagram in self._outgoing.packed(frame):
            self._put(datagram)

    def recv_epoch_block(self) -> FrameBlock:
        """All frames that arrived until now; stamps in seconds since 1970, as the sending side gave them.

        Raises:
            CanOperationError: no one serves the bus any more.
        """
        if time.monotonic() - self._hello_s > _HELLO_EVERY_S:
            self._hello_s = time.monotonic()
            self._put(self._hello)
        blocks = []
        while (datagram := self._next()) is not None:
            kind = kind_of(datagram)
            if kind is Kind.FRAMES:
                blocks.append(self._incoming.frames(datagram))
            elif kind is Kind.BYE:
                raise can.CanOperationError(f"the bench at {self._address} has ended")
        if self.lost > 2 * self._told:
            self._told = self.lost
            _LOG.warning("%s: %d frames lost on the way so far", self.channel_info, self.lost)
        return joined(blocks) if blocks else empty_block()

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        end_s = None if timeout is None else time.monotonic() + timeout
        while not self._waiting:
            self._waiting += [_message(frame) for frame in self.recv_epoch_block()]
            left_s = _HELLO_EVERY_S if end_s is None else min(_HELLO_EVERY_S, end_s - time.monotonic())
            if self._waiting or left_s <= 0:
                break
            select.select([self._socket], [], [], left_s)
        return (self._waiting.popleft() if self._waiting else None), False

    def fileno(self) -> int:
        """The socket, to be waited for."""
        return self._socket.fileno()

    def shutdown(self) -> None:
        """Leave the bus."""
        if not self._is_shutdown:
            super().shutdown()
            with contextlib.suppress(OSError):
                self._socket.send(signal(Kind.BYE))
            self._socket.close()

    def _ask(self) -> Welcome:
        """Take part; the hub's answer."""
        end_s = time.monotonic() + _WELCOME_WITHIN_S
        while time.monotonic() < end_s:
            with contextlib.suppress(ConnectionRefusedError):
                self._socket.send(self._hello)
            select.select([self._socket], [], [], _ASK_EVERY_S)
            with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
                while True:
                    datagram = self._socket.recv(LARGEST)
                    if kind_of(datagram) is Kind.WELCOME:
                        return welcome_of(datagram)
        raise can.CanInitializationError(
            f"no simulated bench at {self._address}; start one with 'hil bench sim'"
        )

    def _put(self, datagram: bytes) -> None:
        try:
            self._socket.send(datagram)
        except OSError as error:
            raise can.CanOperationError(f"Failed to transmit: {error.strerror}", error.errno) from error

    def _next(self) -> bytes | None:
        try:
            return self._socket.recv(LARGEST)
        except BlockingIOError:
            return None
        except OSError as error:
            raise can.CanOperationError(f"Failed to receive: {error.strerror}", error.errno) from error


def _message(frame: np.void) -> can.Message:
    length = int(frame["length"])
    return can.Message(
        timestamp=float(frame["time_s"]),
        arbitration_id=int(frame["id"]),
        is_extended_id=bool(frame["flags"] & EXTENDED),
        is_error_frame=bool(frame["flags"] & ERROR_FRAME),
        is_rx=not frame["flags"] & SENT_BY_HOST,
        data=int(frame["data"]).to_bytes(8, "little")[:length],
    )
