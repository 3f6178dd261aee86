import re

import numpy as np
import pytest

from drivers import BusLoop, DynoDriver, DynoNodes, VehicleParameters, Wire
from drivers.dyno import identifiers_of, read_dyno
from hil.core.can.frames import FRAME
from hil.core.errors import BadInputError, BenchError
from sim_backend.bench import Fault
from sim_backend.can_interface import SimulatedBus, attached
from tests.benches_for_tests import SIM, running


def test_the_vehicle_model_is_told_and_read_back():
    vehicle = SIM.vehicle.model_copy(update={"inertia_kg_m2": 250.0, "rolling_nm": 20.0, "slip": 0.05})
    with running("vehicle", vehicle=vehicle) as bench:
        bench.loop.run_for(0.01)
        left = attached("vehicle").dynos[0]
        assert [left.number(0x2000, i) for i in (1, 2)] == [250.0, 20.0]
        assert left.number(0x2000, 4) == pytest.approx(0.05)


def test_the_dynos_watch_their_host_and_send_when_told():
    with running("configured"):
        left, right, *_ = attached("configured").dynos
        for node in (left, right):
            assert node.number(0x1016, 1) == 127 << 16 | 200  # off when the host is silent for 200 ms
            assert node.number(0x1017, 0) == 100
        assert left.number(0x1006, 0) == 1000
        assert left.number(0x1005, 0) == 1 << 30 | 0x80


def test_a_speed_is_held_until_the_vehicle_is_released():
    with running("modes") as bench:
        dynos = attached("modes").dynos[:2]
        bench.dyno.enable(50.0)
        assert [node.number(0x6060, 0) for node in dynos] == [3, 3]
        bench.dyno.release_vehicle(2.5)
        assert [node.number(0x6060, 0) for node in dynos] == [-1, -1]
        assert dynos[0].number(0x2000, 6) == 2.5
        bench.dyno.hold_speed(4.0)
        assert [node.number(0x6060, 0) for node in dynos] == [3, 3]
        bench.loop.run_for(1.0)
        assert bench.dyno.wheel_speed_rad_s == pytest.approx(4.0, abs=0.1)


def test_states_are_reached_and_left():
    with running("states") as bench:
        bench.dyno.enable(10.0)
        assert bench.dyno.left.state == "operation enabled"
        assert not bench.dyno.is_safe()
        bench.dyno.make_safe()
        assert bench.loop.wait_for(bench.dyno.is_safe, 0.1)


def test_enabling_resets_a_fault_without_passing_through_torque():
    with running("reset") as bench:
        world = attached("reset")
        world.dynos[1].power.fail()
        bench.loop.run_for(0.05)
        assert bench.dyno.right.state == "fault"
        bench.dyno.enable(10.0)
        assert bench.dyno.right.state == "operation enabled"


def test_a_deaf_dyno_is_named():
    with running("deaf") as bench:
        attached("deaf").fail(Fault.DYNO_DEAF)
        with pytest.raises(BenchError, match="rear left.*node 3"):
            bench.dyno.enable(10.0)


def test_a_drive_that_does_not_follow_is_told_within_half_a_second():
    with running("unled") as bench:
        attached("unled").tamper = Lossy(0x204)
        began_s = bench.loop.clock.now_s()
        with pytest.raises(BenchError, match="rear right is in 'switch on disabled'"):
            bench.dyno.enable(10.0)
        assert bench.loop.clock.now_s() - began_s < 0.7


def test_missing_nodes_are_named():
    with running("missing"):
        world = attached("missing")
        wire = Wire("dyno", SimulatedBus("missing/dyno"), world)
        nodes = DynoNodes(3, 9, {"front left": 8})
        driver = DynoDriver(BusLoop(world, [wire]), wire, SIM.dyno.eds, nodes, VehicleParameters())
        with pytest.raises(BenchError, match=r"rear right \(node 9\), front left \(node 8\)"):
            driver.come_up()
        wire.close()


def test_idle_nodes_that_are_missing_are_told_and_not_watched():
    with running("missing") as bench:
        world = attached("missing")
        wire = Wire("dyno", SimulatedBus("missing/dyno"), world)
        nodes = DynoNodes(3, 4, {"front left": 8, "front right": 2})
        loop = BusLoop(world, [bench.loop.wires[0], wire])
        driver = DynoDriver(loop, wire, SIM.dyno.eds, nodes, VehicleParameters())
        loop.every(0.05, driver.beat)
        driver.come_up()
        assert driver.missing == ["front left (node 8)"]
        assert driver.troubles() == []
        wire.close()


def test_an_eds_without_the_measured_values_is_refused(tmp_path):
    path = tmp_path / "other.eds"
    path.write_text(SIM.dyno.eds.read_text().replace("0x21010020", "0x2ABC0020"))
    with running("eds") as bench, pytest.raises(BadInputError, match="0x2ABC"):
        DynoDriver(bench.loop, bench.loop.wires[1], path, DynoNodes(3, 4), VehicleParameters())


@pytest.mark.parametrize("place", ["1005", "1006", "1016", "1017", "6060", "6083", "2000"])
def test_an_eds_without_what_is_written_is_refused(place, tmp_path):
    path = tmp_path / "other.eds"
    text = re.sub(rf"(?ms)^\[{place}(sub\d+)?\].*?(?=^\[)", "", SIM.dyno.eds.read_text())
    path.write_text(re.sub(rf"(?m)^\d+=0x{place}$", "", text))
    with pytest.raises(BadInputError, match=f"has no object 0x{place}"):
        read_dyno(path, 3)


def test_what_is_measured_is_also_read_by_sdo():
    with running("measured") as bench:
        bench.dyno.enable(50.0)
        bench.dyno.hold_speed(5.0)
        bench.loop.run_for(1.0)
        assert bench.dyno.left.measured("Wheel speed") == pytest.approx(5.0, abs=0.05)
        assert bench.dyno.left.measured("no such object") is None


def test_what_a_dyno_said_long_ago_is_no_news():
    with running("old-news") as bench:
        assert bench.dyno.is_safe()
        attached("old-news").fail(Fault.DYNO_SILENT)
        bench.loop.run_for(0.1)
        assert not bench.dyno.is_safe()


class Lossy:
    """Frames that never arrive."""

    def __init__(self, *lost):
        self._lost = lost

    def time_passes(self, now_s): ...

    def look(self, first, rows): ...

    def to_nodes(self, bus, frame_id, data):
        return [] if frame_id in self._lost else [(frame_id, data)]

    def to_hosts(self, bus, block):
        return block[~np.isin(block["id"], self._lost)]


def test_one_that_beats_but_measures_nothing_does_not_come_up():
    with running("mute") as bench:
        world = attached("mute")
        world.tamper = Lossy(0x183, 0x184, 0x283, 0x284)
        wire = Wire("dyno", SimulatedBus("mute/dyno"), world)
        loop = BusLoop(world, [bench.loop.wires[0], wire])
        driver = DynoDriver(loop, wire, SIM.dyno.eds, DynoNodes(3, 4), VehicleParameters())
        loop.every(0.05, driver.beat)
        with pytest.raises(BenchError, match="the rear dynos send no measured values"):
            driver.come_up()
        assert not driver.is_safe()
        wire.close()


def test_each_identifier_of_a_node_is_named():
    assert identifiers_of(3, "rear left") == {
        0x000: "NMT",
        0x080: "SYNC",
        0x083: "EMCY of rear left",
        0x183: "values of rear left",
        0x203: "command of rear left",
        0x283: "status of rear left",
        0x583: "SDO answer of rear left",
        0x603: "SDO request of rear left",
        0x703: "heartbeat of rear left",
    }


def test_emergencies_are_told():
    with running("emcy") as bench:
        world = attached("emcy")
        world.dynos[0]._node.emcy.send(0x4310, 1)
        bench.loop.run_for(0.05)
        assert any("0x4310" in text for text in bench.dyno.troubles())


@pytest.mark.parametrize(("identifier", "length"), [(0x083, 3), (0x703, 0)])
def test_a_frame_too_short_for_canopen_is_told_and_stops_nothing_else(identifier, length):
    with running("short") as bench:
        frame = np.zeros(1, FRAME)
        frame["id"], frame["length"], frame["time_s"] = identifier, length, bench.loop.clock.now_s()
        bench.loop.hand_out("dyno", frame)
        bench.loop.run_for(0.02)
        assert bench.dyno.troubles() == [
            f"frame 0x{identifier:03X} with {length} bytes: too short for CANopen"
        ]


def test_a_device_that_maps_otherwise_than_its_eds_is_refused(tmp_path):
    path = tmp_path / "swapped.eds"
    text = SIM.dyno.eds.read_text()
    speed, torque = "DefaultValue=0x21010020", "DefaultValue=0x21000020"
    assert speed in text
    assert torque in text
    path.write_text(text.replace(speed, "X").replace(torque, speed).replace("X", torque))
    with running("swapped"):
        world = attached("swapped")
        wire = Wire("dyno", SimulatedBus("swapped/dyno"), world)
        nodes = DynoNodes(3, 4)
        driver = DynoDriver(BusLoop(world, [wire]), wire, path, nodes, VehicleParameters())
        with pytest.raises(BenchError, match=r"0x1A00, subindex 1 is 0x21010020 in the device"):
            driver.come_up()
        assert {text for _, text in driver._read_pdos()} == {
            "object 0x1A00, subindex 1 is 0x21010020 in the device, 0x21000020 in swapped.eds",
            "object 0x1A00, subindex 2 is 0x21000020 in the device, 0x21010020 in swapped.eds",
        }
        wire.close()


def test_pdos_elsewhere_are_used_as_the_eds_says(tmp_path):
    path = tmp_path / "elsewhere.eds"
    text = SIM.dyno.eds.read_text()
    assert "DefaultValue=$NODEID+0x180" in text
    path.write_text(text.replace("DefaultValue=$NODEID+0x180", "DefaultValue=$NODEID+0x380"))
    table = SIM.dyno.model_copy(update={"eds": path})
    assert 0x383 in table.identifiers()
    assert 0x183 not in table.identifiers()
    with running("elsewhere", dyno=table) as bench:
        bench.dyno.enable(50.0)
        bench.dyno.hold_speed(4.0)
        bench.loop.run_for(1.0)
        assert bench.dyno.wheel_speed_rad_s == pytest.approx(4.0, abs=0.1)
