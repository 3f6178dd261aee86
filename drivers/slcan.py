"""Adapters that speak slcan over a serial line, with what python-can's own class leaves out.

It reads in blocks and not byte by byte, never waits for a line that takes nothing, and understands what the
adapter says of its bus, in the dialect of Linux' driver (drivers/net/can/slcan/slcan-core.c): `s` with a
state (a, w, p, b: active, warning, passive, bus-off), receive and transmit error counter (three digits each);
`e` with the number of errors and a letter for each. They become error frames as SocketCAN has them. A bell
after the bus was opened is a frame that was refused.
"""

from __future__ import annotations

import time
from collections import deque
from typing import Any

import can
from can.interfaces.slcan import slcanBus

from drivers import bus_health as errors
from drivers.serial_line import written_at_once

_QUIET_S = 0.02  # after this long without an answer the adapter has answered all that opening asks
_ANSWERED_S = 0.1  # and after this long even if its bus is never quiet
_LONGEST_LINE = 200
_NO_LINE = b"?"  # begins nothing that an adapter says
_STATES = {
    "a": (errors.CONTROLLER, errors.ACTIVE_AGAIN),
    "w": (errors.CONTROLLER, errors.WARNING),
    "p": (errors.CONTROLLER, errors.PASSIVE),
    "b": (errors.BUS_OFF, 0),
}
_ERRORS = {
    "a": (errors.NO_ACKNOWLEDGE, 0),
    "b": (errors.PROTOCOL | errors.BUS_ERROR, 0),
    "B": (errors.PROTOCOL | errors.BUS_ERROR, 0),
    "c": (errors.PROTOCOL | errors.BUS_ERROR, 0),
    "f": (errors.PROTOCOL | errors.BUS_ERROR, 0),
    "s": (errors.PROTOCOL | errors.BUS_ERROR, 0),
    "o": (errors.CONTROLLER, errors.RECEIVE_OVERFLOW),
    "O": (errors.CONTROLLER, errors.TRANSMIT_OVERFLOW),
}


class SlcanBus(slcanBus):
    """A bus behind an slcan adapter; arguments are those of python-can's."""

    def __init__(self, channel: str, **kwargs: Any) -> None:
        self._ready: deque[can.Message] = deque()
        self._unsent = b""  # the end of a line that was written in part
        # Neither means anything to this kind of adapter beyond its `timing`.
        kwargs.pop("fd", None)
        kwargs.pop("data_bitrate", None)
        super().__init__(channel, **kwargs)
        self.serialPortOrig.timeout = 0
        self._forget_answers()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Hand one frame to the adapter; a line that takes nothing is not waited for.

        Raises:
            CanOperationError: the line is gone, or full.
        """
        del timeout
        super().send(msg, 0)

    def send_frame(self, frame_id: int, data: bytes) -> None:
        """Hand one standard data frame to the adapter."""
        self._write(f"t{frame_id:03X}{len(data)}{data.hex().upper()}")

    def _write(self, string: str) -> None:
        data = self._unsent + string.encode() + self.LINE_TERMINATOR
        try:
            if self.serialPortOrig.write_timeout != 0:
                self.serialPortOrig.write_timeout = 0
            written = written_at_once(self.serialPortOrig, data)
        except (OSError, TypeError) as error:  # TypeError: closed meanwhile
            raise can.CanOperationError(
                f"Could not write to serial device: {error}", getattr(error, "errno", None)
            ) from error
        if not written:
            raise can.CanOperationError("Transmit buffer full")
        self._unsent = data[written:]

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        end_s = None if timeout is None else time.monotonic() + timeout
        while not self._ready:
            self._take()
            if self._ready or (end_s is not None and time.monotonic() >= end_s):
                break
            time.sleep(0.0005)
        return (self._ready.popleft() if self._ready else None), False

    def _take(self) -> None:
        """Whatever has come, as messages."""
        try:
            data = self.serialPortOrig.read(max(1, self.serialPortOrig.in_waiting))
        except (OSError, TypeError) as error:
            raise can.CanOperationError(
                f"Could not read from serial device: {error}", getattr(error, "errno", None)
            ) from error
        if not data:
            return
        stamp = time.time()
        self._buffer += data.replace(self._ERROR, self._ERROR + self._OK)
        *lines, rest = bytes(self._buffer).split(self._OK)
        self._buffer = bytearray(rest[-_LONGEST_LINE:])
        for line in lines:
            message = _message(line, stamp)
            if message is not None:
                self._ready.append(message)

    def _forget_answers(self) -> None:
        """What the adapter answers to being opened: a bell for closing what was closed already."""
        opened = quiet_since = time.monotonic()
        while time.monotonic() - quiet_since < _QUIET_S:
            if self.serialPortOrig.in_waiting:
                self.serialPortOrig.reset_input_buffer()
                quiet_since = time.monotonic()
            if quiet_since - opened > _ANSWERED_S:  # others talk: what is read next may be the end of a line
                self._buffer = bytearray(_NO_LINE)
                return
            time.sleep(0.002)


def _message(line: bytes, stamp: float) -> can.Message | None:
    """The frame or error that a line tells; None for everything else, also for lines that are damaged."""
    try:
        text = line.decode("ascii")
        kind = text[:1]
        if kind == "t":
            return _frame(text, stamp, 3, is_extended_id=False)
        if kind in ("T", "x"):
            return _frame(text, stamp, 8, is_extended_id=True)
        if kind == "r":
            return can.Message(stamp, int(text[1:4], 16), False, True, dlc=int(text[4]))
        if kind == "R":
            return can.Message(stamp, int(text[1:9], 16), True, True, dlc=int(text[9]))
        if kind in ("d", "b", "D", "B"):
            return _fd_frame(text, stamp, 3 if kind in "db" else 8, switched=kind in "bB")
        if kind == "s" and text[1:2] in _STATES:
            return errors.frame(stamp, *_STATES[text[1]], received=int(text[2:5]), sent=int(text[5:8]))
        if kind == "e":
            texts = [_ERRORS[letter] for letter in text[2 : 2 + int(text[1])] if letter in _ERRORS]
            return errors.joined(stamp, texts)
        if kind == "\a":
            return errors.frame(stamp, errors.CONTROLLER, errors.TRANSMIT_OVERFLOW)
    except (ValueError, IndexError):
        pass
    return None


def _frame(text: str, stamp: float, digits: int, *, is_extended_id: bool) -> can.Message:
    length = int(text[1 + digits])
    data = bytes.fromhex(text[2 + digits : 2 + digits + 2 * length])
    if len(data) != length:
        raise ValueError("cut off")
    return can.Message(stamp, int(text[1 : 1 + digits], 16), is_extended_id, data=data)


def _fd_frame(text: str, stamp: float, digits: int, *, switched: bool) -> can.Message:
    length = can.util.dlc2len(int(text[1 + digits], 16))
    data = bytes.fromhex(text[2 + digits : 2 + digits + 2 * length])
    if len(data) != length:
        raise ValueError("cut off")
    extended = digits > 3
    identifier = int(text[1 : 1 + digits], 16)
    return can.Message(stamp, identifier, extended, data=data, is_fd=True, bitrate_switch=switched)
