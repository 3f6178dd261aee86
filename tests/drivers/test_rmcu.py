import re

import numpy as np
import pytest

from drivers import BusLoop, RmcuDriver, Wire
from hil.core.controller import load_controller
from hil.core.errors import BadInputError, BenchError
from sim_backend.bench import Fault
from sim_backend.can_interface import SimulatedBus, attached
from test_plans import load_plan
from tests.benches_for_tests import SIM, running

CONTROLLERS = load_plan("acceptance").source.parent / "controllers"


def test_a_controller_is_written_and_read_back():
    controller = load_controller(CONTROLLERS / "phase_stabilization.toml")
    with running("write") as bench:
        bench.rmcu.write_controller(controller)
        bench.loop.run_for(0.02)
        stored = attached("write").rmcu._stored
    assert stored["k_p"] == np.float32(2.6775)
    assert stored["lead_gain"] == np.float32(controller.wsc.lead.alpha)
    assert stored["notch_frequency"] == 0.0
    assert stored["den_5"] == 1.0
    assert stored["shaft_0"] == 0.0


def test_a_refused_parameter_is_named_with_the_reason():
    controller = load_controller(CONTROLLERS / "gain_stabilization.toml")
    with running("refused") as bench:
        with pytest.raises(BenchError, match="torque_limit.*out_of_range"):
            bench.rmcu.write_controller(controller.model_copy(update={"torque_limit_nm": 1e4}))
        for payload in bench.rmcu.requests("motor_torque", np.zeros(3)):
            bench.rmcu.send(payload)
            bench.loop.step()
        with pytest.raises(BenchError, match="not_off"):
            bench.rmcu.write_controller(controller)


def test_an_unstable_filter_is_refused_by_the_rmcu():
    controller = load_controller(CONTROLLERS / "gain_stabilization.toml")
    plant = controller.plant.model_copy(update={"shaft_torque": (1.0, -5.0, 1.0)})
    with running("unstable") as bench, pytest.raises(BenchError, match="apply.*out_of_range"):
        bench.rmcu.write_controller(controller.model_copy(update={"plant": plant}))


def test_a_silent_rmcu_is_named():
    controller = load_controller(CONTROLLERS / "gain_stabilization.toml")
    with running("silent") as bench:
        attached("silent").fail(Fault.RMCU_SILENT)
        with pytest.raises(BenchError, match="no reply"):
            bench.rmcu.write_controller(controller)


def test_counters_go_on_from_block_to_block():
    with running("counters") as bench:
        payloads = [
            *bench.rmcu.requests("motor_torque", np.zeros(10)),
            *bench.rmcu.requests("off", np.zeros(10)),
        ]
        counters = [int(payload) & 15 for payload in payloads]
        assert counters == [(counters[0] + i) % 16 for i in range(20)]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("MotorSpeed", "Drehzahl"), "'RMCU_Status' has no signal 'MotorSpeed'"),
        (("RMCU_Request", "Request"), "no message 'RMCU_Request'"),
        (("BO_ 256", "BO_ x256"), "not a DBC"),
    ],
)
def test_a_dbc_that_lacks_something_is_refused_by_name(change, said, tmp_path):
    path = tmp_path / "other.dbc"
    path.write_text(SIM.rmcu.dbc.read_text().replace(*change))
    with running("dbc"):
        world = attached("dbc")
        bus = SimulatedBus("dbc/rmcu")
        wire = Wire("rmcu", bus, world)
        with pytest.raises(BadInputError, match=said):
            RmcuDriver(BusLoop(world, [wire]), wire, path)
        wire.close()


def test_a_missing_dbc_says_where_to_look(tmp_path):
    with running("nodbc") as bench, pytest.raises(BadInputError, match=r"\[rmcu\] dbc"):
        RmcuDriver(bench.loop, bench.loop.wires[0], tmp_path / "none.dbc")


def changed(change):
    """Somebody on the wire who changes what the RMCU sends."""

    class Tamper:
        on = False

        def time_passes(self, now_s): ...

        def look(self, first, rows): ...

        def to_nodes(self, bus, frame_id, data):
            return [(frame_id, data)]

        def to_hosts(self, bus, block):
            return change(block.copy()) if self.on and bus == "rmcu" else block

    return Tamper()


def with_wrong_checksum(block):
    block["data"][block["id"] == 0x111] ^= np.uint64(1 << 60)
    return block


def with_another_state(block):
    block["data"][block["id"] == 0x111] ^= np.uint64(1)
    return block


def with_one_count(block, kept=[]):  # noqa: B006 - what came first is sent again and again
    kept = kept or kept.append(block["data"][block["id"] == 0x111][-1]) or kept
    block["data"][block["id"] == 0x111] = kept[0]
    return block


def cut_short(block):
    block["length"] = np.minimum(block["length"], 2)
    return block


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (with_wrong_checksum, "the RMCU's frames come with wrong checksums"),
        (with_another_state, "the RMCU's frames come with wrong checksums"),
        (with_one_count, "the RMCU's counter stands still"),
        (cut_short, None),  # as if nothing came
    ],
)
def test_frames_that_cannot_be_believed_say_nothing(change, said):
    with running("unbelievable") as bench:
        tamper = attached("unbelievable").tamper = changed(change)
        bench.loop.run_for(0.05)
        assert bench.rmcu.is_safe()
        for source in bench.sources:
            list(source.samples())
        tamper.on = True
        seen_s = bench.rmcu.last_seen_s
        bench.loop.run_for(0.1)
        assert bench.rmcu.last_seen_s <= seen_s + 0.02
        assert not bench.rmcu.is_safe()
        assert bench.rmcu.troubles() == ([said] if said else [])
        if not said:
            frames = [s for s in bench.rmcu.sources[0].samples() if s.stream.channels]
            assert frames == []
        tamper.on = False
        bench.loop.run_for(0.05)
        assert bench.rmcu.troubles() == []
        assert bench.rmcu.is_safe()


def test_an_rmcu_that_has_not_been_heard_yet_is_in_no_trouble_and_not_safe_either():
    with running("unheard") as bench:
        rmcu = RmcuDriver(bench.loop, bench.loop.wires[0], SIM.rmcu.dbc)
        assert rmcu.troubles() == []
        assert not rmcu.is_safe()
        assert not rmcu.is_powerless()
        with pytest.raises(BenchError, match="sends no status"):
            rmcu.come_up()


@pytest.mark.parametrize(("bits", "counted_by"), [(8, 8), (5, 5), (4, 4), (3, 4), (1, 4)])
def test_the_longer_of_both_counters_counts(bits, counted_by, tmp_path):
    path = tmp_path / "short.dbc"
    text = SIM.rmcu.dbc.read_text()
    path.write_text(
        text.replace("SG_ Counter : 48|8@1+ (1,0) [0|255]", f"SG_ Counter : 48|{bits}@1+ (1,0) [0|1]")
    )
    with running("short-counter") as bench:
        counts = RmcuDriver(bench.loop, bench.loop.wires[0], path)._counted_by()
    assert counts.counter.length == counted_by
    assert (counts.name, counts.opens) == (("RMCU_Control", False) if bits >= 4 else ("RMCU_Status", True))


@pytest.mark.parametrize(("bits", "counted_by"), [(3, 3), (2, None), (1, None)])
def test_a_counter_counts_from_three_bits_on(bits, counted_by, tmp_path):
    path = tmp_path / "short.dbc"
    text = SIM.rmcu.dbc.read_text().replace(
        ' SG_ Counter : 0|4@1+ (1,0) [0|15] "" HOST\n SG_ MotorS', " SG_ MotorS"
    )
    text = text.replace('CM_ SG_ 272 Counter "Number of the sample, modulo 16.";\n', "")
    path.write_text(
        text.replace("SG_ Counter : 48|8@1+ (1,0) [0|255]", f"SG_ Counter : 48|{bits}@1+ (1,0) [0|1]")
    )
    with running("shorter-counter") as bench:
        counts = RmcuDriver(bench.loop, bench.loop.wires[0], path)._counted_by()
    assert (counts.counter.length if counts.counter else None) == counted_by
    assert (counts.name, counts.opens) == (("RMCU_Control", False) if counted_by else ("RMCU_Status", True))


def test_a_silent_rmcu_is_found_when_it_is_looked_at():
    with running("looked-at") as bench:
        assert bench.rmcu.examine(ask=False).answers
        attached("looked-at").fail(Fault.RMCU_SILENT)
        bench.loop.run_for(0.25)
        found = bench.rmcu.examine(ask=True)
        assert not found.answers
        assert "has stopped sending its status" in found.findings[0].what
        assert bench.rmcu.identify() == {}


@pytest.mark.parametrize(
    "change",
    [
        lambda control: control.replace(' SG_ Crc : 56|8@1+ (1,0) [0|255] "" HOST\n', ""),
        lambda control: control.replace("Counter : 48|8", "Moved : 56|8").replace("Crc : 56|8", "Crc : 48|8"),
    ],
)
def test_a_checksum_that_is_not_the_last_byte_is_not_looked_at(change, tmp_path):
    before, at, rest = SIM.rmcu.dbc.read_text().partition("BO_ 273 ")
    control, end, after = rest.partition("BO_ 274 ")
    path = tmp_path / "other.dbc"
    path.write_text("".join((before, at, change(control), end, after)))
    with running("unchecked") as bench:
        rmcu = RmcuDriver(bench.loop, bench.loop.wires[0], path)
        bench.loop.run_for(0.1)
        assert (rmcu.is_safe(), rmcu.troubles()) == (True, [])


class Damaging:
    """Changes bits of one frame in ten."""

    def __init__(self):
        self._random = np.random.default_rng(1)

    def time_passes(self, now_s):
        pass

    def look(self, first, rows):
        pass

    def to_hosts(self, bus, block):
        place = self._random.integers(0, 10, len(block)) == 0
        block["data"][place] ^= np.uint64(0x10)
        return block

    def to_nodes(self, bus, frame_id, data):
        return [(frame_id, data)]


def test_damaged_frames_are_counted_and_named_with_their_bus():
    with running("damaged") as bench:
        assert bench.rmcu.damage == ""
        attached("damaged").tamper = Damaging()
        bench.loop.run_for(0.3)
        said = re.fullmatch(
            r"bus 'rmcu': \d+ of \d+ frames RMCU_Status, (\d+) of (\d+) frames RMCU_Control are damaged "
            r"\(wrong checksum\)",
            bench.rmcu.damage,
        )
    assert said
    assert 15 < int(said[1]) < 60
    assert int(said[2]) >= 300
