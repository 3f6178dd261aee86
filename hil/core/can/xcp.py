"""XCP on CAN (ASAM MCD-1 XCP 1.x), as much as measuring needs: codes, and how numbers lie in packets."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntEnum


class Command(IntEnum):
    """First byte of what a master sends."""

    CONNECT = 0xFF
    DISCONNECT = 0xFE
    GET_STATUS = 0xFD
    SYNCH = 0xFC
    GET_COMM_MODE_INFO = 0xFB
    GET_ID = 0xFA
    SET_MTA = 0xF6
    UPLOAD = 0xF5
    SHORT_UPLOAD = 0xF4
    CLEAR_DAQ_LIST = 0xE3
    SET_DAQ_PTR = 0xE2
    WRITE_DAQ = 0xE1
    SET_DAQ_LIST_MODE = 0xE0
    GET_DAQ_LIST_MODE = 0xDF
    START_STOP_DAQ_LIST = 0xDE
    START_STOP_SYNCH = 0xDD
    GET_DAQ_CLOCK = 0xDC
    READ_DAQ = 0xDB
    GET_DAQ_PROCESSOR_INFO = 0xDA
    GET_DAQ_RESOLUTION_INFO = 0xD9
    GET_DAQ_LIST_INFO = 0xD8
    GET_DAQ_EVENT_INFO = 0xD7
    FREE_DAQ = 0xD6
    ALLOC_DAQ = 0xD5
    ALLOC_ODT = 0xD4
    ALLOC_ODT_ENTRY = 0xD3


#: First byte of what a slave sends; below these it is the number of an ODT, and measured data follow.
ANSWER, ERROR, EVENT, SERVICE = 0xFF, 0xFE, 0xFD, 0xFC
LARGEST_ODT_NUMBER = 0xFB
MOST_BYTES = 8  # of a packet on CAN


class Code(IntEnum):
    """What an ERROR says."""

    CMD_SYNCH = 0x00
    CMD_BUSY = 0x10
    DAQ_ACTIVE = 0x11
    CMD_UNKNOWN = 0x20
    CMD_SYNTAX = 0x21
    OUT_OF_RANGE = 0x22
    ACCESS_DENIED = 0x24
    ACCESS_LOCKED = 0x25
    MODE_NOT_VALID = 0x27
    SEQUENCE = 0x29
    DAQ_CONFIG = 0x2A
    MEMORY_OVERFLOW = 0x30
    GENERIC = 0x31
    RESOURCE_NOT_ACCESSIBLE = 0x33


class Happened(IntEnum):
    """What an EVENT tells."""

    CMD_PENDING = 0x05
    DAQ_OVERLOAD = 0x06
    SESSION_TERMINATED = 0x07


#: Error codes in words that a message can go on with: "the slave …".
IN_WORDS = {
    Code.CMD_BUSY: "is busy",
    Code.DAQ_ACTIVE: "is measuring and refuses this now",
    Code.CMD_UNKNOWN: "does not know this command",
    Code.CMD_SYNTAX: "does not understand it",
    Code.OUT_OF_RANGE: "refuses a value in it",
    Code.ACCESS_DENIED: "does not let this memory be read",
    Code.ACCESS_LOCKED: "is locked: it wants seed and key",
    Code.MODE_NOT_VALID: "has no such mode",
    Code.SEQUENCE: "refuses commands in this order",
    Code.DAQ_CONFIG: "refuses this measurement list",
    Code.MEMORY_OVERFLOW: "has no room for so many symbols",
    Code.GENERIC: "fails",
    Code.RESOURCE_NOT_ACCESSIBLE: "has no access to it at present",
}

# Bits of COMM_MODE_BASIC, RESOURCE, DAQ_PROPERTIES, session status, list modes
MOTOROLA, GRANULARITY = 0x01, 0x06
RESOURCE_DAQ = LOCKED_DAQ = 0x04
DYNAMIC, PRESCALER, TIME_STAMPS = 0x01, 0x02, 0x10
DAQ_RUNNING = 0x40
LIST_TIME_STAMPED, LIST_SELECTED, LIST_RUNNING = 0x10, 0x01, 0x40
OVERLOAD_BY_EVENT = 0x80
IDENTIFICATION_FIELD = 0xC0  # of the DAQ key byte: 0 is an absolute ODT number
STOP, START, SELECT = 0, 1, 2  # START_STOP_DAQ_LIST
STOP_ALL, START_SELECTED, STOP_SELECTED = 0, 1, 2  # START_STOP_SYNCH
WHOLE_ENTRY = 0xFF  # bit offset of an entry that is no single bit
_TIME_UNITS_S = {unit: 10.0 ** (unit - 9) for unit in range(10)} | {
    10 + n: 10.0 ** (n - 12) for n in range(3)
}
_SIZES = (0, 1, 2, 4)


@dataclass(frozen=True)
class Connected:
    """What a slave answers to CONNECT.

    Attributes:
        order: "<" if it counts as Intel does, ">" as Motorola.
        measures: whether it has DAQ lists at all.
        bytes_each: of an address: 1, 2 or 4.
        most_in_command, most_in_data: largest packet of commands, and of data, bytes.
    """

    order: str
    measures: bool
    bytes_each: int
    most_in_command: int
    most_in_data: int


@dataclass(frozen=True)
class TimeStamps:
    """How a slave counts time: bytes of a stamp (0: none), seconds of a count, whether always sent."""

    size: int
    tick_s: float
    fixed: bool


def connected(packet: bytes) -> Connected:
    """Read the answer to CONNECT.

    Raises:
        struct.error: it is too short.
    """
    resource, mode, most = struct.unpack_from("<xBBB", packet)
    order = ">" if mode & MOTOROLA else "<"
    (most_in_data,) = struct.unpack_from(f"{order}4xH", packet)
    return Connected(
        order, bool(resource & RESOURCE_DAQ), 1 << ((mode & GRANULARITY) >> 1), most, most_in_data
    )


def time_stamps(mode: int, ticks: int) -> TimeStamps:
    """Read TIMESTAMP_MODE and TIMESTAMP_TICKS of a slave.

    Raises:
        ValueError: no such size or unit.
    """
    size = mode & 0x07
    if size not in _SIZES or mode >> 4 not in _TIME_UNITS_S:
        raise ValueError(f"time stamps of mode 0x{mode:02X}")
    return TimeStamps(size, ticks * _TIME_UNITS_S[mode >> 4], bool(mode & 0x08))


def time_stamp_mode(size: int, unit_s: float) -> int:
    """TIMESTAMP_MODE of stamps of so many bytes that count such units, s."""
    return size | _unit_of(unit_s) << 4


def period_s(cycle: int, unit: int) -> float:
    """Distance of an event channel's samples, s; 0.0: it has no cycle.

    Raises:
        ValueError: no such unit.
    """
    if cycle and unit not in _TIME_UNITS_S:
        raise ValueError(f"an event's cycle in unit {unit}")
    return cycle * _TIME_UNITS_S[unit] if cycle else 0.0


def cycle_and_unit(period: float) -> tuple[int, int]:
    """How an event channel says its period, s: whole milliseconds."""
    return round(period * 1e3), _unit_of(1e-3)


def _unit_of(unit_s: float) -> int:
    return next(unit for unit, second in _TIME_UNITS_S.items() if abs(second - unit_s) < 1e-6 * unit_s)


def in_words(code: int) -> str:
    """What an error code says, to go on with after "the slave"."""
    try:
        return IN_WORDS[Code(code)]
    except (ValueError, KeyError):
        return f"says error 0x{code:02X}"
