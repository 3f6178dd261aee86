"""The objects of a node as an SDO server gives and takes them, and the CiA 402 state machine.

Abort codes are those of CiA 301, table 22; states those of IEC 61800-7-201, without transitional ones.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import Any

import canopen
from canopen.objectdictionary import NUMBER_TYPES, ODVariable
from canopen.sdo import SdoAbortedError, SdoServer


class State(Enum):
    """States with their statusword bits (6, 5, 3, 2, 1, 0)."""

    SWITCH_ON_DISABLED = 0x40
    READY_TO_SWITCH_ON = 0x21
    SWITCHED_ON = 0x23
    OPERATION_ENABLED = 0x27
    QUICK_STOP_ACTIVE = 0x07
    FAULT = 0x08


_FAULT_RESET = 0x80


class PowerStates:
    """Follows the controlword; `state` decides whether the drive gives torque."""

    def __init__(self) -> None:
        self.state = State.SWITCH_ON_DISABLED
        self._last = 0

    @property
    def statusword(self) -> int:
        """Statusword with voltage enabled (bit 4)."""
        return self.state.value | 0x10

    def command(self, controlword: int) -> None:
        """Apply one controlword; fault reset counts on its rising edge only."""
        rising = controlword & ~self._last
        self._last = controlword
        if self.state is State.FAULT:
            if rising & _FAULT_RESET:
                self.state = State.SWITCH_ON_DISABLED
            return
        self.state = self._next(controlword)

    def fail(self) -> None:
        """Enter FAULT: torque off until reset."""
        self.state = State.FAULT

    def _next(self, word: int) -> State:
        if not word & 0x02:  # disable voltage
            return State.SWITCH_ON_DISABLED
        if not word & 0x04:  # quick stop
            enabled = self.state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
            return State.QUICK_STOP_ACTIVE if enabled else State.SWITCH_ON_DISABLED
        if not word & 0x01:  # shutdown
            return State.READY_TO_SWITCH_ON
        on = self.state is not State.SWITCH_ON_DISABLED
        if not on:
            return self.state  # a drive that has not been readied does not switch on
        if not word & 0x08:
            return State.SWITCHED_ON
        ready = self.state in (State.SWITCHED_ON, State.OPERATION_ENABLED)
        return State.OPERATION_ENABLED if ready else State.SWITCHED_ON


_SDO_LENGTH = 8
_SERVICE = 0xE0
_SEGMENTS = (0 << 5, 3 << 5)  # download segment, upload segment: nothing without a transfer that was started
_ABORT = 4 << 5
_EXPEDITED, _SIZE_SPECIFIED = 0x02, 0x01

UNKNOWN_COMMAND = 0x05040001
WRITE_READ_ONLY = 0x06010002
NO_OBJECT = 0x06020000
LENGTH_TOO_HIGH, LENGTH_TOO_LOW = 0x06070012, 0x06070013
NO_SUBINDEX = 0x06090011
INVALID_VALUE, VALUE_TOO_HIGH, VALUE_TOO_LOW = 0x06090030, 0x06090031, 0x06090032


class ServedNode(canopen.LocalNode):  # type: ignore[misc]
    """canopen's node, strict about what does not exist, does not fit or is out of range."""

    def __init__(self, node_id: int, dictionary: Any) -> None:
        super().__init__(node_id, dictionary)
        self.sdo = _Server(0x600 + self.id, 0x580 + self.id, self)

    def set_data(self, index: int, subindex: int, data: bytes, check_writable: bool = False) -> None:
        """Write an object; canopen takes what is beyond the limits of the EDS, and what is no number.

        Raises:
            SdoAbortedError: with the code of CiA 301.
        """
        obj = self.check_download(index, subindex, len(data)) if check_writable else None
        if obj is not None and obj.data_type in NUMBER_TYPES:
            check_value(obj.decode_raw(data), obj.min, obj.max)
        super().set_data(index, subindex, data, check_writable)

    def check_download(self, index: int, subindex: int, size: int | None) -> ODVariable:
        """The object, if it can be written with `size` bytes (None: not known yet).

        Raises:
            SdoAbortedError: with the code of CiA 301.
        """
        obj = self._find_object(index, subindex)
        if not obj.writable:
            raise SdoAbortedError(WRITE_READ_ONLY)
        if size is not None and obj.data_type in NUMBER_TYPES and 8 * size != len(obj):
            raise SdoAbortedError(LENGTH_TOO_HIGH if 8 * size > len(obj) else LENGTH_TOO_LOW)
        return obj

    def _find_object(self, index: int, subindex: int) -> ODVariable:
        if index not in self.object_dictionary:
            raise SdoAbortedError(NO_OBJECT)
        obj = self.object_dictionary[index]
        # canopen answers every subindex of a variable, and makes up what an array does not have
        members = {0: obj} if isinstance(obj, ODVariable) else obj.subindices
        if subindex not in members:
            raise SdoAbortedError(NO_SUBINDEX)
        return members[subindex]


def check_value(value: float, low: float | None, high: float | None) -> None:
    """Refuse a number that is none or lies out of its range.

    Raises:
        SdoAbortedError: with the code of CiA 301.
    """
    if not math.isfinite(value):
        raise SdoAbortedError(INVALID_VALUE)
    if high is not None and value > high:
        raise SdoAbortedError(VALUE_TOO_HIGH)
    if low is not None and value < low:
        raise SdoAbortedError(VALUE_TOO_LOW)


class _Server(SdoServer):  # type: ignore[misc]
    """canopen's server, which trips over transfers that no one began and refuses only when all has come."""

    def on_request(self, can_id: int, data: bytearray, timestamp: float) -> None:
        """Answer one frame of a client."""
        if len(data) != _SDO_LENGTH:
            return  # no SDO
        service = data[0] & _SERVICE
        if service == _ABORT:
            self._buffer = None
        elif service in _SEGMENTS and self._buffer is None:
            self._index = self._subindex = 0
            self.abort(UNKNOWN_COMMAND)
        else:
            super().on_request(can_id, data, timestamp)

    _buffer: bytearray | None  # canopen's: what of a segmented transfer has come, or is still to go

    def init_upload(self, request: bytearray) -> None:
        """Begin to read."""
        self._buffer = None
        super().init_upload(request)

    def init_download(self, request: bytearray) -> None:
        """Begin to write; what cannot be written is refused now, not after its last segment."""
        self._buffer = None
        self._index, self._subindex = int.from_bytes(request[1:3], "little"), request[3]
        expedited, sized = request[0] & _EXPEDITED, request[0] & _SIZE_SPECIFIED
        size = int.from_bytes(request[4:8], "little") if sized and not expedited else None
        obj = self._node.check_download(self._index, self._subindex, size)
        if expedited and not sized:  # the length is left to the object
            length = min(len(obj) // 8, 4)
            request[0] |= _SIZE_SPECIFIED | (4 - length) << 2
        super().init_download(request)

    def segmented_download(self, command: int, request: bytearray) -> None:
        """Take a segment; more than the object holds is refused at once."""
        obj = self._node.check_download(self._index, self._subindex, None)
        if obj.data_type in NUMBER_TYPES and self._buffer is not None and len(self._buffer) > len(obj) // 8:
            raise SdoAbortedError(LENGTH_TOO_HIGH)
        super().segmented_download(command, request)
        if command & 0x01:  # the last one
            self._buffer = None

    def abort(self, abort_code: int = 0x08000000) -> None:
        """Refuse, and forget the transfer."""
        self._buffer = None
        if self._index is None:
            self._index = self._subindex = 0
        super().abort(abort_code)
