"""What reads bytes of the panel's line, of XCP, and files of symbols."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np

from drivers import BusLoop, Wire, open_can
from drivers.can_adapter import CanSettings
from drivers.table import Connections
from hil.core.ak import Request, Telegrams, answer_of
from hil.core.can.frames import FRAME
from hil.core.can.symbol_files import read_symbols
from hil.core.can.xcp import Command
from hil.core.errors import BadInputError
from hil.core.recording import column_map, read_recording
from hil.engine import load_bench
from hil.plant.closed_loop import tick as T
from sim_backend.rcs import EmulatedPanel
from sim_backend.rmcu import RamSettings, RmcuMemory, XcpSlave
from tests.clocks import SteppedClock

_PACKET_BYTES = 9  # length and eight bytes
_MEASURED_FIRST = [bytes([number, *range(7)]) for number in range(6)]
_ANSWERS = [b"\xff", b"\xff\x40\x00\x00\x00\x00", b"\xfe\x20", b"\xfd\x06", b"\xfc\x01"]


#: Text as ControlDesk, LabVIEW, INCA and a test bench write it.
TABLES = (
    b"path,,M/T,M/n\nname,xAxis,T,n\nunit,s,Nm,rpm\ntype,f8,f8,f8\ntrace_values,0,1,2\n,0.001,1,2\n",
    b"LabVIEW Measurement\t\nDelta_X\t0,001\n***End_of_Header***\t\nX_Value\tT\tn\tComment\n"
    b"0\t1,5\t2\n1e-3\t1\t2\n",
    b"ETASAsciiItemFile\trecord\nsampleCount\t2\ntime\tT\\E:1\tn\t\nf8\tf8\tf8\t\n"
    b's\tNm\t"rpm"\t\n0\t1\t2\t\n1\t1\t2\t\n',
    b"Bench: 7\nTIME;T;n\nhh:mm:ss;Nm;1/min\n23:59:59.999;1;2\n00:00:00.000;1;1.#IND\n\nMIN;1;2\n",
)


def mapped(path: Path) -> object:
    """A table of another tool, with a map of its columns."""
    options = ("motor_torque_ref_nm=T", "motor_speed_rad_s=n, unit=rpm, wraps=65536")
    return read_recording(path, columns=column_map(options))


def symbols(path: Path) -> object:
    """Every symbol of a file, as if it were measured."""
    found = read_symbols(path)
    for name in found.by_name:
        with contextlib.suppress(BadInputError):
            symbol = found.find(name)
            symbol.values(symbol.raw(np.array([1.5]), "<"), "<")
    return found


def telegrams(path: Path) -> object:
    """Bytes on the panel's line, to either side."""
    data = path.read_bytes()
    panel = EmulatedPanel()
    return panel.hear(data), [answer_of(text) for text in Telegrams().feed(data)]


def of_telegrams() -> list[bytes]:
    """Requests and their answers."""
    asked = [Request("SREM"), Request("ASTZ"), Request("EMAS", ("1850",)), Request("AFW0"), Request("ASTF")]
    panel = EmulatedPanel()
    return [b"".join(request.telegram() + panel.hear(request.telegram()) for request in asked)]


def packets(data: bytes) -> list[bytes]:
    """Each a length and eight bytes."""
    whole = data[: len(data) // _PACKET_BYTES * _PACKET_BYTES]
    cut = [whole[at : at + _PACKET_BYTES] for at in range(0, len(whole), _PACKET_BYTES)]
    return [piece[1 : 2 + piece[0] % 8] for piece in cut]


def _laid(found: list[bytes]) -> bytes:
    return b"".join(bytes([len(packet) - 1]) + packet.ljust(8, b"\0") for packet in found)


def from_the_slave() -> list[bytes]:
    """Answers, events and measured data."""
    return [_laid(_MEASURED_FIRST * 3 + _ANSWERS), _laid(_ANSWERS)]


def to_the_slave() -> list[bytes]:
    """A session."""
    numbers = [(Command.CONNECT, 0), (Command.FREE_DAQ,), (Command.ALLOC_DAQ, 0, 1, 0)]
    numbers += [(Command.ALLOC_ODT, 0, 0, 0, 2), (Command.ALLOC_ODT_ENTRY, 0, 0, 0, 0, 1)]
    numbers += [(Command.SET_DAQ_PTR, 0, 0, 0, 0, 0), (Command.WRITE_DAQ, 255, 4, 0, 0, 1, 0, 32)]
    numbers += [(Command.SET_DAQ_LIST_MODE, 16, 0, 0, 0, 0, 1, 0), (Command.START_STOP_DAQ_LIST, 2, 0, 0)]
    numbers += [
        (Command.START_STOP_SYNCH, 1),
        (Command.GET_STATUS,),
        (Command.SHORT_UPLOAD, 4, 0, 0, 0, 1, 0, 32),
    ]
    return [_laid([bytes(packet) for packet in numbers])]


def heard_by_the_monitor(path: Path) -> object:
    """What a slave sends, to the monitor that measures there."""
    table = load_bench("sim_whole").devices["ram"]
    name = "ram"
    wire = Wire(name, open_can(CanSettings(name, "virtual", "fuzz", 1_000_000)), SteppedClock())
    try:
        loop = BusLoop(SteppedClock(), [wire])
        monitor = table.open("ram", Connections(loop, {"ram": wire}))
        found = packets(path.read_bytes())
        block = np.zeros(len(found), FRAME)
        block["id"] = 0x551
        block["length"] = [len(packet) for packet in found]
        block["data"] = [int.from_bytes(packet, "little") for packet in found]
        for half in (block[: len(block) // 3], block[len(block) // 3 :]):
            for callback in loop._block_callbacks:
                callback("ram", half)
        return [list(source.samples()) for source in monitor.sources], monitor.troubles()
    finally:
        wire.close()


def heard_by_the_slave(path: Path) -> object:
    """What a master sends, to the emulated RMCU."""
    file, variables, ids = load_bench("sim_whole").devices["ram"].read()  # type: ignore[attr-defined]
    memory = RmcuMemory(
        RamSettings(
            bus="ram",
            bit_rate=1_000_000,
            request_id=ids[0],
            answer_id=ids[1],
            variables=variables,
            software=file.software,
            software_address=file.software_address,
        )
    )
    said: list[bytes] = []
    slave = XcpSlave(memory, lambda a, n: memory.read(np.zeros(T.COLUMNS), a, n), said.append)
    for packet in packets(path.read_bytes()):
        slave.receive(packet, 1.0)
    return said, slave.running
