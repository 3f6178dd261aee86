"""A dyno's objects, read and written by a foreign master: canopen's own, which knows the EDS and no more."""

from __future__ import annotations

import struct
from typing import Any

import canopen
import numpy as np
import pytest
from canopen.objectdictionary import NUMBER_TYPES, ODVariable

from hil.plant.closed_loop import drive as law
from sim_backend.rcs import DynoNode
from tests.benches_for_tests import SIM, running

NODE = 3


class Master(canopen.Network):  # type: ignore[misc]
    """canopen's network, wired to one node without a bus between them."""

    def __init__(self, eds=SIM.dyno.eds) -> None:
        super().__init__()
        self.row = np.zeros(law.COLUMNS)
        self.answers: list[bytes] = []
        self.dyno = DynoNode(NODE, eds, self._hear, self.row)
        self.node: Any = self.add_node(NODE, str(eds))
        self.node.sdo.RESPONSE_TIMEOUT = 0.01
        self.node.sdo.MAX_RETRIES = 0

    def send_message(self, can_id, data, remote=False):
        self.dyno.receive(can_id, bytes(data), 0.0)

    def _hear(self, frame_id, data):
        if frame_id == 0x580 + NODE:
            self.answers.append(data)
        self.notify(frame_id, bytearray(data), 0.0)

    def read(self, index, subindex=0):
        return self.node.sdo.upload(index, subindex)

    def write(self, index, subindex, data, **how):
        self.node.sdo.download(index, subindex, data, **how)

    def request(self, *data):
        """The abort code that a request frame is answered with; None: no answer; 0: another answer."""
        self.answers = []
        self.send_message(0x600 + NODE, bytes(data))
        if not self.answers:
            return None
        (answer,) = self.answers
        return int.from_bytes(answer[4:], "little") if answer[0] == 0x80 else 0


def variables(dictionary):
    for index in dictionary:
        entry = dictionary[index]
        members = [entry] if isinstance(entry, ODVariable) else entry.subindices.values()
        for variable in members:
            yield pytest.param(index, variable, id=f"{index:04X}sub{variable.subindex}")


EVERY_OBJECT = list(variables(canopen.import_od(str(SIM.dyno.eds), NODE)))
WRITABLE = [case for case in EVERY_OBJECT if case.values[1].writable]


def abort_of(work, *arguments, **options):
    with pytest.raises(canopen.SdoAbortedError) as caught:
        work(*arguments, **options)
    return caught.value.code


@pytest.mark.parametrize(("index", "variable"), EVERY_OBJECT)
def test_every_object_of_the_eds_is_read_and_written_as_the_eds_says(index, variable):
    master = Master()
    data = master.read(index, variable.subindex)
    if variable.data_type in NUMBER_TYPES:
        assert len(data) == len(variable) // 8
    if index in (0x6041, 0x6061):  # they follow the drive
        pass
    elif (index, variable.subindex) == (0x1018, 4):  # every node has a serial number of its own
        assert variable.decode_raw(data) == 1000 + NODE
    else:
        assert data == variable.encode_raw(variable.default)
    if variable.writable:
        master.write(index, variable.subindex, variable.encode_raw(variable.default))
        assert master.read(index, variable.subindex) == data
    else:
        assert abort_of(master.write, index, variable.subindex, data) == 0x06010002


@pytest.mark.parametrize(("index", "variable"), EVERY_OBJECT)
def test_neighbours_that_do_not_exist_are_refused(index, variable):
    master = Master()
    entry = master.node.object_dictionary[index]
    there = {0} if isinstance(entry, ODVariable) else set(entry.subindices)
    for subindex in sorted({variable.subindex + 1, 0x7F, 0xFF} - there):
        assert abort_of(master.read, index, subindex) == 0x06090011
        assert abort_of(master.write, index, subindex, b"\0") == 0x06090011


@pytest.mark.parametrize(("index", "variable"), WRITABLE)
def test_data_of_another_length_are_refused(index, variable):
    master, length = Master(), len(variable) // 8
    for how in ({}, {"force_segment": True}):
        assert abort_of(master.write, index, variable.subindex, bytes(length + 1), **how) == 0x06070012
        if length > 1:
            assert abort_of(master.write, index, variable.subindex, bytes(length - 1), **how) == 0x06070013


def test_an_object_that_does_not_exist_is_refused():
    master = Master()
    for index in (0x1002, 0x5FFF, 0x9999):
        assert abort_of(master.read, index) == 0x06020000
        assert abort_of(master.write, index, 0, b"\0") == 0x06020000


REAL32 = struct.Struct("<f").pack


@pytest.mark.parametrize(
    ("index", "subindex", "data", "code"),
    [
        (0x6060, 0, b"\x01", 0x06090030),  # profile position: not among the supported drive modes
        (0x6060, 0, b"\x80", 0x06090030),
        (0x2000, 1, REAL32(0.0), 0x06090032),  # a vehicle without inertia
        (0x2000, 1, REAL32(float("nan")), 0x06090030),
        (0x2000, 2, REAL32(-1.0), 0x06090032),
        (0x2000, 3, REAL32(float("inf")), 0x06090030),
        (0x2000, 4, REAL32(1.0), 0x06090031),  # wheels that stand still beside a moving vehicle
        (0x2000, 5, REAL32(-0.33), 0x06090032),
        (0x2000, 6, REAL32(1e9), 0x06090031),
        (0x1005, 0, b"\x81\0\0\x40", 0x06090030),  # the SYNC is 0x80
        (0x1006, 0, (500).to_bytes(4, "little"), 0x06090030),
        (0x1016, 1, (0x80_0064).to_bytes(4, "little"), 0x06090030),  # node 128
        (0x1600, 1, (0x60710010).to_bytes(4, "little"), 0x06090030),  # the mapping is not changed
        (0x1800, 1, (0x181).to_bytes(4, "little"), 0x06090030),
    ],
)
def test_values_that_the_drive_does_not_take_are_refused_and_change_nothing(index, subindex, data, code):
    master = Master()
    before = master.read(index, subindex)
    assert abort_of(master.write, index, subindex, data) == code
    assert master.read(index, subindex) == before


def test_limits_of_the_eds_are_kept(tmp_path):
    eds = tmp_path / "limited.eds"
    text = SIM.dyno.eds.read_text()
    eds.write_text(text.replace("[6083]\n", "[6083]\nLowLimit=10\nHighLimit=200000\n"))
    master = Master(eds=eds)
    assert abort_of(master.write, 0x6083, 0, (200_001).to_bytes(4, "little")) == 0x06090031
    assert abort_of(master.write, 0x6083, 0, (9).to_bytes(4, "little")) == 0x06090032
    master.write(0x6083, 0, (200_000).to_bytes(4, "little"))


def test_transfers_that_nobody_began_and_broken_frames_are_answered_or_ignored():
    master = Master()
    assert master.request(0x60, 0, 0, 0, 0, 0, 0, 0) == 0x05040001  # upload segment
    assert master.request(0x01, 0, 0, 0, 0, 0, 0, 0) == 0x05040001  # download segment
    assert master.request(0xE0, 0, 0, 0, 0, 0, 0, 0) == 0x05040001  # no such service
    assert master.request(0x40, 0x60) is None  # no SDO: it is too short
    assert master.request() is None
    assert master.request(0x80, 0x60, 0x60, 0, 0, 0, 0, 0) is None  # an abort is not answered
    assert master.request(0x22, 0x60, 0x60, 0, 3, 0, 0, 0) == 0  # expedited, its length left to the object
    assert master.read(0x6060) == b"\x03"


def test_a_segmented_transfer_that_never_ends_is_ended():
    master = Master()
    assert master.request(0x20, 0x83, 0x60, 0, 0, 0, 0, 0) == 0  # without a size
    assert master.request(0x00, 0, 0, 0, 0, 0, 0, 0) == 0  # 7 bytes of 4
    assert master.request(0x10, 0, 0, 0, 0, 0, 0, 0) == 0x06070012
    assert master.request(0x00, 0, 0, 0, 0, 0, 0, 0) == 0x05040001


def test_no_mode_leaves_the_drive_free_and_a_mode_is_shown():
    master = Master()
    for word in (6, 7, 15):
        master.write(0x6040, 0, word.to_bytes(2, "little"))
    for mode, does in ((3, law.SPEED), (0, law.FREE), (4, law.TORQUE), (-1, law.VEHICLE)):
        master.node.sdo[0x6060].raw = mode
        assert (master.node.sdo[0x6061].raw, master.row[law.MODE]) == (mode, does)


def test_commands_by_pdo_and_measured_values_show_in_the_dictionary():
    with running("shown") as bench:
        bench.dyno.enable(10.0)
        bench.dyno.hold_speed(5.0)
        bench.loop.run_for(1.0)
        sdo = bench.dyno.left._node.sdo
        assert sdo[0x60FF].phys == pytest.approx(5.0)
        assert sdo[0x6040].raw == 0x0F
        assert sdo[0x2101].phys == pytest.approx(bench.dyno.left.wheel_speed_rad_s, abs=0.05)
        assert sdo[0x606C].phys == pytest.approx(sdo[0x2101].phys, abs=0.05)
        assert sdo[0x6077].raw != 0
