"""The emulated RMCU as an XCP slave: what it answers to commands, and which lists it sends."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field

from hil.core.can.xcp import (
    ANSWER,
    DAQ_RUNNING,
    DYNAMIC,
    ERROR,
    EVENT,
    LARGEST_ODT_NUMBER,
    LIST_RUNNING,
    LIST_SELECTED,
    LIST_TIME_STAMPED,
    MOST_BYTES,
    MOTOROLA,
    OVERLOAD_BY_EVENT,
    PRESCALER,
    RESOURCE_DAQ,
    SELECT,
    START,
    START_SELECTED,
    STOP_ALL,
    TIME_STAMPS,
    WHOLE_ENTRY,
    Code,
    Command,
    Happened,
    cycle_and_unit,
    time_stamp_mode,
)
from hil.core.channels import TICK_S
from sim_backend.rmcu._memory import RmcuMemory

STAMP_BYTES, STAMP_TICK_S = 2, 1e-4
_EVENT_NAME = b"control cycle"
_NAME = b"emulated RMCU"
_MOST_LISTS, _MOST_ODTS, _MOST_ENTRIES = 8, 64, 7
_VERSION = 0x01


@dataclass
class DaqList:
    """What is sent together: ODTs of (address, size)."""

    odts: list[list[tuple[int, int]]] = field(default_factory=list)
    stamped: bool = False
    every: int = 1
    selected: bool = False
    running: bool = False
    first: int = 0  # number of its first ODT


class _RefusedError(Exception):
    def __init__(self, code: Code) -> None:
        super().__init__(code)
        self.code = code


class XcpSlave:
    """Answers one command at a time.

    Args:
        look: bytes of memory now, by address and size.
        send: puts a packet on the bus.
        dynamic: whether a master allocates lists; else it has one of `static` ODTs.
    """

    def __init__(
        self,
        memory: RmcuMemory,
        look: Callable[[int, int], bytes],
        send: Callable[[bytes], None],
        order: str = "<",
        static: int = 0,
    ) -> None:
        self._memory, self._look, self._send = memory, look, send
        self._order, self._static = order, static
        self.now_s = 0.0
        self.reset()

    def reset(self) -> None:
        """As after power on: no one is connected, nothing is sent."""
        self.connected = False
        self.lists: list[DaqList] = []
        if self._static:
            self.lists = [DaqList([[] for _ in range(self._static)])]
        self._pointer: tuple[int, int, int] | None = None
        self._rooms: list[list[int]] = []  # entries that were allocated, by list and ODT
        self._text = b""  # what UPLOAD gives in place of memory
        self._mta = 0

    @property
    def running(self) -> list[DaqList]:
        """The lists that are being sent."""
        return [entry for entry in self.lists if entry.running]

    def overloaded(self) -> None:
        """Tell that samples are left out."""
        self._send(bytes([EVENT, Happened.DAQ_OVERLOAD]))

    def receive(self, packet: bytes, now_s: float) -> None:
        """A master's command, at a time of the RMCU's clock."""
        self.now_s = now_s
        if not packet or (not self.connected and packet[0] != Command.CONNECT):
            return
        try:
            command = Command(packet[0])
            answer = _ANSWERS[command](self, packet.ljust(MOST_BYTES, b"\0"))
        except (ValueError, KeyError):
            self._send(bytes([ERROR, Code.CMD_UNKNOWN]))
        except _RefusedError as refused:
            self._send(bytes([ERROR, refused.code]))
        else:
            self._send(bytes([ANSWER]) + answer)

    # --- the session ---

    def _connect(self, packet: bytes) -> bytes:
        self.connected = True
        mode = MOTOROLA if self._order == ">" else 0
        return bytes([RESOURCE_DAQ, mode, MOST_BYTES]) + self._packed("HBB", MOST_BYTES, _VERSION, _VERSION)

    def _disconnect(self, packet: bytes) -> bytes:
        self.reset()
        return b""

    def _status(self, packet: bytes) -> bytes:
        return self._packed("BBxH", DAQ_RUNNING if self.running else 0, 0, 0)

    def _synch(self, packet: bytes) -> bytes:
        raise _RefusedError(Code.CMD_SYNCH)

    def _comm_mode(self, packet: bytes) -> bytes:
        return bytes([0, 0, 0, 0, 0, 0, _VERSION])

    def _id(self, packet: bytes) -> bytes:
        self._text = _NAME if packet[1] in (0, 1) else b""
        return self._packed("BHI", 0, 0, len(self._text))

    # --- memory ---

    def _set_mta(self, packet: bytes) -> bytes:
        (self._mta,) = self._read(packet, "xxxxI")
        self._text = b""
        return b""

    def _upload(self, packet: bytes) -> bytes:
        count = packet[1]
        if not 0 < count < MOST_BYTES:
            raise _RefusedError(Code.OUT_OF_RANGE)
        if self._text:
            piece, self._text = self._text[:count], self._text[count:]
            return piece.ljust(count, b"\0")
        data = self._memory_at(self._mta, count)
        self._mta += count
        return data

    def _short_upload(self, packet: bytes) -> bytes:
        count, address = self._read(packet, "xBxxI")
        if not 0 < count < MOST_BYTES:
            raise _RefusedError(Code.OUT_OF_RANGE)
        self._mta = address + count
        return self._memory_at(address, count)

    def _memory_at(self, address: int, count: int) -> bytes:
        if not self._memory.has(address, count):
            raise _RefusedError(Code.ACCESS_DENIED)
        return self._look(address, count)

    # --- what there is ---

    def _processor(self, packet: bytes) -> bytes:
        properties = (0 if self._static else DYNAMIC) | PRESCALER | TIME_STAMPS | OVERLOAD_BY_EVENT
        least = 1 if self._static else 0
        return self._packed("BHHBB", properties, len(self.lists) or _MOST_LISTS, 1, least, 0)

    def _resolution(self, packet: bytes) -> bytes:
        return self._packed("BBBBBH", 1, 7, 1, 7, time_stamp_mode(STAMP_BYTES, STAMP_TICK_S), 1)

    def _event(self, packet: bytes) -> bytes:
        if self._read(packet, "xxH") != (0,):
            raise _RefusedError(Code.OUT_OF_RANGE)
        self._text = _EVENT_NAME
        return bytes([0x04, 0xFF, len(_EVENT_NAME), *cycle_and_unit(TICK_S), 0])

    def _list_info(self, packet: bytes) -> bytes:
        daq = self._list(self._read(packet, "xxH")[0])
        return self._packed("BBBH", 0x04, len(daq.odts), _MOST_ENTRIES, 0)

    def _clock(self, packet: bytes) -> bytes:
        return self._packed("xxxI", round(self.now_s / STAMP_TICK_S) & 0xFFFF_FFFF)

    # --- lists ---

    def _free(self, packet: bytes) -> bytes:
        if self._static:
            raise _RefusedError(Code.CMD_UNKNOWN)
        self.lists, self._rooms, self._pointer = [], [], None
        return b""

    def _allocate(self, packet: bytes) -> bytes:
        (count,) = self._read(packet, "xxH")
        if self._static or self.lists:
            raise _RefusedError(Code.SEQUENCE)
        if count > _MOST_LISTS:
            raise _RefusedError(Code.MEMORY_OVERFLOW)
        self.lists = [DaqList() for _ in range(count)]
        self._rooms = [[] for _ in range(count)]
        return b""

    def _allocate_odts(self, packet: bytes) -> bytes:
        number, count = self._read(packet, "xxHB")
        daq = self._list(number)
        if self._static or daq.odts:
            raise _RefusedError(Code.SEQUENCE)
        if sum(len(other.odts) for other in self.lists) + count > _MOST_ODTS:
            raise _RefusedError(Code.MEMORY_OVERFLOW)
        daq.odts = [[] for _ in range(count)]
        self._rooms[number] = [0] * count
        return b""

    def _allocate_entries(self, packet: bytes) -> bytes:
        number, odt, count = self._read(packet, "xxHBB")
        daq = self._list(number)
        if self._static:
            raise _RefusedError(Code.SEQUENCE)
        if odt >= len(daq.odts) or count > _MOST_ENTRIES:
            raise _RefusedError(Code.OUT_OF_RANGE)
        self._rooms[number][odt] = count
        return b""

    def _clear(self, packet: bytes) -> bytes:
        daq = self._list(self._read(packet, "xxH")[0])
        daq.odts = [[] for _ in daq.odts]
        daq.running = daq.selected = False
        return b""

    def _set_pointer(self, packet: bytes) -> bytes:
        number, odt, entry = self._read(packet, "xxHBB")
        daq = self._list(number)
        if odt >= len(daq.odts) or entry >= self._room(number, odt):
            raise _RefusedError(Code.OUT_OF_RANGE)
        self._pointer = (number, odt, entry)
        return b""

    def _write(self, packet: bytes) -> bytes:
        bit, size, _, address = self._read(packet, "xBBBI")
        if self._pointer is None:
            raise _RefusedError(Code.SEQUENCE)
        number, odt, entry = self._pointer
        entries = self._list(number).odts[odt]
        taken = sum(taken_size for _, taken_size in entries)
        if bit != WHOLE_ENTRY or entry != len(entries) or entry >= self._room(number, odt):
            raise _RefusedError(Code.OUT_OF_RANGE)
        if not size > 0 or taken + size > MOST_BYTES - 1 or self.running:
            raise _RefusedError(Code.DAQ_CONFIG)
        if not self._memory.has(address, size):
            raise _RefusedError(Code.ACCESS_DENIED)
        entries.append((address, size))
        self._pointer = (number, odt, entry + 1)
        return b""

    def _set_mode(self, packet: bytes) -> bytes:
        mode, number, event, every, _ = self._read(packet, "xBHHBB")
        daq = self._list(number)
        if event or not every:
            raise _RefusedError(Code.OUT_OF_RANGE)
        if mode & ~LIST_TIME_STAMPED:
            raise _RefusedError(Code.MODE_NOT_VALID)
        room = MOST_BYTES - 1 - (STAMP_BYTES if mode else 0)
        if not daq.odts or sum(size for _, size in daq.odts[0]) > room:
            raise _RefusedError(Code.DAQ_CONFIG)
        daq.stamped, daq.every = bool(mode), every
        return b""

    def _mode(self, packet: bytes) -> bytes:
        daq = self._list(self._read(packet, "xxH")[0])
        mode = LIST_RUNNING * daq.running | LIST_SELECTED * daq.selected | LIST_TIME_STAMPED * daq.stamped
        return self._packed("BxxHBB", mode, 0, daq.every, 0)

    def _start_stop(self, packet: bytes) -> bytes:
        mode, number = self._read(packet, "xBH")
        daq = self._list(number)
        if mode > SELECT:
            raise _RefusedError(Code.MODE_NOT_VALID)
        if mode and not all(daq.odts):
            raise _RefusedError(Code.DAQ_CONFIG)
        daq.first = sum(len(other.odts) for other in self.lists[:number])
        if daq.first + len(daq.odts) > LARGEST_ODT_NUMBER:
            raise _RefusedError(Code.DAQ_CONFIG)
        if mode == SELECT:
            daq.selected = True
        else:
            daq.running = mode == START
        return bytes([daq.first])

    def _start_stop_all(self, packet: bytes) -> bytes:
        mode = packet[1]
        for daq in self.lists:
            if mode == STOP_ALL:
                daq.running = daq.selected = False
            elif daq.selected:
                daq.running, daq.selected = mode == START_SELECTED, False
        return b""

    def _list(self, number: int) -> DaqList:
        if number >= len(self.lists):
            raise _RefusedError(Code.OUT_OF_RANGE)
        return self.lists[number]

    def _room(self, number: int, odt: int) -> int:
        return _MOST_ENTRIES if self._static else self._rooms[number][odt]

    def _packed(self, layout: str, *values: int) -> bytes:
        return struct.pack(f"{self._order}{layout}", *values)

    def _read(self, packet: bytes, layout: str) -> tuple[int, ...]:
        return struct.unpack_from(f"{self._order}{layout}", packet)


_ANSWERS: dict[Command, Callable[[XcpSlave, bytes], bytes]] = {
    Command.CONNECT: XcpSlave._connect,
    Command.DISCONNECT: XcpSlave._disconnect,
    Command.GET_STATUS: XcpSlave._status,
    Command.SYNCH: XcpSlave._synch,
    Command.GET_COMM_MODE_INFO: XcpSlave._comm_mode,
    Command.GET_ID: XcpSlave._id,
    Command.SET_MTA: XcpSlave._set_mta,
    Command.UPLOAD: XcpSlave._upload,
    Command.SHORT_UPLOAD: XcpSlave._short_upload,
    Command.GET_DAQ_PROCESSOR_INFO: XcpSlave._processor,
    Command.GET_DAQ_RESOLUTION_INFO: XcpSlave._resolution,
    Command.GET_DAQ_EVENT_INFO: XcpSlave._event,
    Command.GET_DAQ_LIST_INFO: XcpSlave._list_info,
    Command.GET_DAQ_CLOCK: XcpSlave._clock,
    Command.FREE_DAQ: XcpSlave._free,
    Command.ALLOC_DAQ: XcpSlave._allocate,
    Command.ALLOC_ODT: XcpSlave._allocate_odts,
    Command.ALLOC_ODT_ENTRY: XcpSlave._allocate_entries,
    Command.CLEAR_DAQ_LIST: XcpSlave._clear,
    Command.SET_DAQ_PTR: XcpSlave._set_pointer,
    Command.WRITE_DAQ: XcpSlave._write,
    Command.SET_DAQ_LIST_MODE: XcpSlave._set_mode,
    Command.GET_DAQ_LIST_MODE: XcpSlave._mode,
    Command.START_STOP_DAQ_LIST: XcpSlave._start_stop,
    Command.START_STOP_SYNCH: XcpSlave._start_stop_all,
}
