"""The emulated RMCU as a slave, packet by packet."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from hil.core.can.symbols import Symbol
from hil.core.can.xcp import Code, Command, connected
from hil.plant.closed_loop import tick as T
from sim_backend.rmcu import RamSettings, RmcuMemory, XcpSlave

ROW = np.zeros(T.COLUMNS)
ROW[T.FEEDFORWARD_TORQUE], ROW[T.SLIP_INTEGRAL] = 12.5, 0.25
SETTINGS = RamSettings(
    "ram", 1_000_000, 0x550, 0x551,
    {"dfc_torque_nm": Symbol("a", 0x100, "f4"), "slip_ref": Symbol("b", 0x104, "i2", "", 0.01)},
    software="SW 1", software_address=0x10,
)  # fmt: skip


class Asked:
    """A slave and what it said."""

    def __init__(self, **keys) -> None:
        self.said: list[bytes] = []
        memory = RmcuMemory(SETTINGS)
        self.slave = XcpSlave(memory, lambda a, n: memory.read(ROW, a, n), self.said.append, **keys)

    def __call__(self, *packet: int) -> bytes:
        self.slave.receive(bytes(packet), 1.5)
        return self.said.pop() if self.said else b""


def connected_one(**keys) -> Asked:
    asked = Asked(**keys)
    asked(Command.CONNECT, 0)
    return asked


def error(code: Code) -> bytes:
    return bytes([0xFE, code])


def test_it_says_nothing_before_it_is_connected() -> None:
    asked = Asked()
    assert asked(Command.GET_STATUS) == b""
    assert connected(asked(Command.CONNECT, 0)).most_in_data == 8
    assert asked(Command.GET_STATUS)[:2] == b"\xff\x00"
    asked(Command.DISCONNECT)
    assert asked(Command.GET_STATUS) == b""


def test_memory_is_read_by_address() -> None:
    asked = connected_one()
    assert asked(Command.SHORT_UPLOAD, 4, 0, 0, *struct.pack("<I", 0x100)) == b"\xff" + struct.pack(
        "<f", 12.5
    )
    assert asked(Command.SHORT_UPLOAD, 2, 0, 0, *struct.pack("<I", 0x104)) == b"\xff" + struct.pack("<h", 25)
    asked(Command.SET_MTA, 0, 0, 0, *struct.pack("<I", 0x10))
    assert asked(Command.UPLOAD, 3) + asked(Command.UPLOAD, 1) == b"\xffSW \xff1"
    assert asked(Command.SHORT_UPLOAD, 4, 0, 0, *struct.pack("<I", 0x104)) == error(Code.ACCESS_DENIED)
    assert asked(Command.UPLOAD, 9) == error(Code.OUT_OF_RANGE)


@pytest.mark.parametrize(
    ("packet", "code"),
    [
        ((0x01,), Code.CMD_UNKNOWN),
        ((0xF0, 1), Code.CMD_UNKNOWN),
        ((Command.SYNCH,), Code.CMD_SYNCH),
        ((Command.WRITE_DAQ, 255, 4, 0, 0, 1, 0, 0), Code.SEQUENCE),
        ((Command.SET_DAQ_PTR, 0, 5, 0, 0, 0), Code.OUT_OF_RANGE),
        ((Command.ALLOC_DAQ, 0, 99, 0), Code.MEMORY_OVERFLOW),
        ((Command.GET_DAQ_EVENT_INFO, 0, 7, 0), Code.OUT_OF_RANGE),
    ],
)
def test_what_it_does_not_take_is_an_error(packet: tuple[int, ...], code: Code) -> None:
    assert connected_one()(*packet) == error(code)


def arranged(asked: Asked, *entries: tuple[int, int]) -> None:
    asked(Command.FREE_DAQ)
    asked(Command.ALLOC_DAQ, 0, 1, 0)
    asked(Command.ALLOC_ODT, 0, 0, 0, 1)
    asked(Command.ALLOC_ODT_ENTRY, 0, 0, 0, 0, len(entries))
    asked(Command.SET_DAQ_PTR, 0, 0, 0, 0, 0)
    for address, size in entries:
        asked(Command.WRITE_DAQ, 255, size, 0, *struct.pack("<I", address))


def test_a_list_is_set_up_started_and_read_back() -> None:
    asked = connected_one()
    arranged(asked, (0x100, 4), (0x104, 1))
    assert asked(Command.SET_DAQ_LIST_MODE, 0x10, 0, 0, 0, 0, 3, 0) == b"\xff"
    assert asked(Command.START_STOP_DAQ_LIST, 2, 0, 0) == b"\xff\x00"
    assert not asked.slave.running
    asked(Command.START_STOP_SYNCH, 1)
    (daq,) = asked.slave.running
    assert (daq.odts, daq.every, daq.stamped) == ([[(0x100, 4), (0x104, 1)]], 3, True)
    assert asked(Command.GET_STATUS)[1] == 0x40
    assert asked(Command.GET_DAQ_LIST_MODE, 0, 0, 0)[1] == 0x50
    asked(Command.START_STOP_SYNCH, 0)
    assert not asked.slave.running


def test_a_list_that_has_no_room_is_refused() -> None:
    asked = connected_one()
    arranged(asked, (0x100, 4), (0x104, 2))  # with a stamp it is a byte too long
    assert asked(Command.SET_DAQ_LIST_MODE, 0x10, 0, 0, 0, 0, 1, 0) == error(Code.DAQ_CONFIG)
    asked(Command.SET_DAQ_PTR, 0, 0, 0, 0, 0)
    assert asked(Command.WRITE_DAQ, 255, 4, 0, 0, 9, 0, 0) == error(Code.OUT_OF_RANGE)  # written already


def test_a_slave_with_lists_of_its_own_allocates_none() -> None:
    asked = connected_one(static=3)
    assert asked(Command.ALLOC_DAQ, 0, 1, 0) == error(Code.SEQUENCE)
    assert asked(Command.GET_DAQ_LIST_INFO, 0, 0, 0)[1:4] == bytes([4, 3, 7])
