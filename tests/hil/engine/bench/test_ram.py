"""Runs with a monitor of the RMCU's memory: its samples beside the bus's, and what goes wrong with it."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from drivers import read_rmcu
from hil.core.can.frames import FrameBlock
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.engine import RunRequest, load_bench, run_plan
from hil.engine.bench.bench_file import bench_from_dict, shipped
from hil.engine.commissioning.doctor import DoctorRequest, examine_bench
from sim_backend.bench import RAM_BUS, SimulatedBench
from sim_backend.can_interface import prepare
from tests.benches_for_tests import SIM, plan

WHOLE = load_bench("sim_whole")
STEPS = """[{set_controller: {file: phase_stabilization.toml}},
  {step: {segment: s, quantity: driving_torque, from_nm: 20, to_nm: 200, before_s: 0.3, after_s: 1}}]"""
WAIT = "[{wait: {duration_s: 2.5}}]"

RESOLUTION_NM = read_rmcu(SIM.rmcu.dbc).layouts["RMCU_Status"].signals["MotorTorqueRef"].scale


def bench(name: str, *, bus: str = "ram", **keys):
    """The whole bench without its panel, and with other keys for the monitor."""
    data = tomllib.loads(WHOLE.text)
    del data["devices"]["panel"]
    data["name"] = name
    data["devices"]["ram"] |= {"bus": bus, **keys}
    if bus != "ram":
        del data["buses"]["ram"]
    for key, table in data["buses"].items():
        table["channel"] = f"{name}/{key}"
    return bench_from_dict(data, tomli_w.dumps(data), WHOLE.source)


def run(folder: Path, name: str, steps: str = STEPS, **keys):
    return run_plan(RunRequest(plan(steps), bench(name, **keys), folder))


def test_internals_stand_beside_the_bus_on_one_time_base(tmp_path: Path) -> None:
    outcome = run(tmp_path, "ram-run")
    assert outcome.error is None, outcome.error
    recording = read_recording(outcome.recording)
    driven = recording["driving_torque_ref_nm"] > 0
    assert np.count_nonzero(driven) > 1000
    # The observer's estimate as the bus rounds it, and as it stands in memory: of the same sample
    bus, memory = recording["driving_torque_est_nm"], recording["observed_torque_nm"]
    assert np.all(np.isfinite(memory))
    assert np.max(np.abs(bus - memory)[driven]) < 0.011
    assert np.max(np.abs(bus[1:] - memory[:-1])[driven[1:]]) > 0.1
    parts = recording["dfc_torque_nm"] + recording["wsc_torque_nm"]
    assert np.max(np.abs(recording["motor_torque_ref_nm"] - parts)[driven]) < RESOLUTION_NM
    (clock,) = [clock for clock in outcome.result.clocks if clock.where == "bus 'ram'"]
    assert (clock.lost, clock.counted_by) == (0, "time stamps of its DAQ list")
    load = {load.bus: load.busiest for load in outcome.result.bus_loads}
    assert 0.6 < load["ram"] < 0.8
    attached = {name for name in recording.attachments if name.endswith(".a2l")}
    assert attached == {"device/devices.ram/rmcu.a2l"}


def test_four_floats_fit_beside_the_rmcus_own_frames(tmp_path: Path) -> None:
    channels = dict(list(tomllib.loads(WHOLE.text)["devices"]["ram"]["channels"].items())[:4])
    outcome = run(tmp_path, "ram-four", bus="rmcu", channels=channels)
    assert outcome.error is None, outcome.error
    recording = read_recording(outcome.recording)
    parts = recording["dfc_torque_nm"] + recording["wsc_torque_nm"]
    driven = recording["driving_torque_ref_nm"] > 0
    assert np.max(np.abs(recording["motor_torque_ref_nm"] - parts)[driven]) < RESOLUTION_NM
    assert 0.8 < outcome.result.bus_loads[0].mean < 1.0


def test_every_fifth_sample_fits_beside_the_rmcus_own_frames(tmp_path: Path) -> None:
    outcome = run(tmp_path, "ram-paced", bus="rmcu", every=5)
    assert outcome.error is None, outcome.error
    recording = read_recording(outcome.recording)
    there = np.isfinite(recording["observed_torque_nm"])
    assert np.all(np.diff(np.flatnonzero(there)) == 5)
    driven = there & (recording["driving_torque_ref_nm"] > 0)
    assert (
        np.max(np.abs(recording["driving_torque_est_nm"] - recording["observed_torque_nm"])[driven]) < 0.011
    )


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"bus": "rmcu"}, "devices.ram.bus = 'rmcu': its frames take up to 665 kbit/s, those of others 540"),
        ({"symbols": "rmcu.dbc"}, "devices.ram.symbols = 'rmcu.dbc': is not a table of symbols"),
        ({"channels": {"dfc_torque_nm": "Tm_DFC"}}, "has no symbol 'Tm_DFC'; did you mean 'Tm_DFC_ref'?"),
        ({"channels": {"dfc_torque": "Tm_DFC_ref"}}, "the simulated RMCU has no such variable; did you mean"),
        ({"answer_id": 0x550}, "request_id and answer_id are both 0x550"),
        ({"bus": "dyno"}, "the simulated RMCU is not on the dynos' bus"),
        ({"channels": {}}, "devices.ram.channels"),
    ],
)
def test_what_cannot_be_is_told_before_anything_is_opened(keys, said: str) -> None:
    with pytest.raises(BadInputError) as refused:
        bench("ram-wrong", **keys)
    assert said in str(refused.value)


@pytest.mark.parametrize("static", [0, 5])
@pytest.mark.parametrize("order", ["<", ">"])
def test_slaves_differ(tmp_path: Path, static: int, order: str) -> None:
    """Lists of their own or allocated ones, either byte order."""

    def other(world: SimulatedBench) -> None:
        slave = world.xcp
        assert slave is not None
        slave._static, slave._order = static, order
        world._ram._order = order
        slave.reset()

    name = f"ram-{static}-{'big' if order == '>' else 'little'}"
    prepare(name, other)
    text = shipped("rmcu.a2l").read_text().replace("BYTE_ORDER MSB_LAST", "")
    (tmp_path / "rmcu.a2l").write_text(text)
    outcome = run(tmp_path / "out", name, WAIT.replace("2.5", "0.3"), symbols=str(tmp_path / "rmcu.a2l"))
    assert outcome.error is None, outcome.error
    assert np.all(np.isfinite(read_recording(outcome.recording)["slip_ref"]))


class Between:
    """Somebody on the memory's bus, from some time on."""

    def __init__(
        self, from_s: float, to_hosts: Callable[[FrameBlock], FrameBlock] = lambda block: block
    ) -> None:
        self.now_s, self._from_s, self._change = 0.0, from_s, to_hosts
        self.changed = 0

    def time_passes(self, now_s: float) -> None:
        self.now_s = now_s

    def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
        if bus != RAM_BUS or self.now_s < self._from_s or not len(block):
            return block
        changed = self._change(block.copy())
        self.changed += len(changed) != len(block) or bool(np.any(changed != block))
        return changed

    def to_nodes(self, bus: str, frame_id: int, data: bytes):
        return [(frame_id, data)]

    def look(self, first: int, rows) -> None:
        pass


def without_answers(block: FrameBlock) -> FrameBlock:
    return block[block["data"] & 0xFF < 0xFC]


def without_one_of_twenty(block: FrameBlock) -> FrameBlock:
    return block if block["time_s"][0] % 0.04 > 0.02 else np.delete(block, 0)


def without_half(block: FrameBlock) -> FrameBlock:
    return np.delete(block, slice(None, None, 10))


def same_stamp(block: FrameBlock) -> FrameBlock:
    first = block["data"] & 0xFF == 0
    block["data"][first] &= ~np.uint64(0xFFFF00)
    return block


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda block: block[:0], "frame 0x551 (dfc_torque_nm) has stopped coming"),
        (without_answers, "the slave has not answered for 1.8 s"),
        (without_one_of_twenty, ""),
        (without_half, "of its samples are lost"),
        (same_stamp, "the time stamps of its samples stand still"),
    ],
    ids=["silent", "no answers", "a lost packet now and then", "many lost packets", "stamps stand still"],
)
def test_a_slave_that_fails_in_a_run(tmp_path: Path, change, said: str) -> None:
    between = Between(1.0, change)
    prepare("ram-fails", lambda world: setattr(world, "tamper", between))
    outcome = run(tmp_path, "ram-fails", WAIT)
    assert between.changed
    assert outcome.result.safe_state == "confirmed"
    assert (outcome.error is None) == (said == "")
    assert said in str(outcome.error)


def test_a_slave_that_starts_again_is_missed_and_the_next_run_goes_well(tmp_path: Path) -> None:
    def later(world: SimulatedBench) -> None:
        class Resets(Between):
            def time_passes(self, now_s: float) -> None:
                if now_s >= 1.0 and not self.changed:
                    self.changed = 1
                    world.reset_xcp()

        world.tamper = Resets(np.inf)

    prepare("ram-resets", later)
    outcome = run(tmp_path / "1", "ram-resets", WAIT)
    assert "has stopped coming" in str(outcome.error)
    assert outcome.result.safe_state == "confirmed"


def test_an_a2l_of_other_software_is_refused(tmp_path: Path) -> None:
    text = shipped("rmcu.a2l").read_text()
    (tmp_path / "rmcu.a2l").write_text(text)
    file = bench("ram-other", symbols=str(tmp_path / "rmcu.a2l"))
    prepare(
        "ram-other",
        lambda world: setattr(world._ram, "_text", np.frombuffer(b"RMCU 9.9.9 DA2024A", np.uint8)),
    )
    outcome = run_plan(RunRequest(plan(WAIT), file, tmp_path / "out"))
    assert "its software is 'RMCU 9.9.9 DA2024A', the symbols are of 'RMCU 1.0.0 DA2024A'" in str(
        outcome.error
    )


def refusing(command: int, answer: bytes, times: int = 1000) -> Callable[[SimulatedBench], None]:
    """A slave that answers one command otherwise."""

    def prepared(world: SimulatedBench) -> None:
        slave = world.xcp
        assert slave is not None
        whole, left = slave.receive, [times]

        def receive(packet: bytes, now_s: float) -> None:
            if packet[0] == command and left[0]:
                left[0] -= 1
                if answer:
                    slave._send(answer)
                return
            whole(packet, now_s)

        slave.receive = receive  # type: ignore[method-assign]

    return prepared


@pytest.mark.parametrize(
    ("command", "answer", "times", "said"),
    [
        (0xFF, b"", 1000, "no answer to CONNECT in 3 attempts of 0.2 s"),
        (0xFF, b"\xff\x04", 1000, "answers to CONNECT with 2 bytes only"),
        (0xDA, b"\xfe\x20", 1000, "GET_DAQ_PROCESSOR_INFO: the slave does not know this command"),
        (0xDA, b"\xff\x13", 1000, "answers with 2 bytes only"),
        (0xDA, b"\xff\x03\x00\x00\x01\x00\x00\x00", 1000, "gives its samples no time stamps"),
        (0xD4, b"\xfe\x30", 1000, "ALLOC_ODT: the slave has no room for so many symbols"),
        (0xD4, b"\xfe\x99", 1000, "ALLOC_ODT: the slave says error 0x99"),
        (0xD4, b"", 1, ""),
        (0xD4, b"\xfe\x10", 5, ""),
        (0xE1, b"\xfe\x10", 1000, "WRITE_DAQ: the slave is busy"),
        (0xD7, b"\xff\x04\xff\x00\x05\x06\x00", 1000, "comes every 5 ms, the bench file says 1 ms"),
        (0xD9, b"\xff\x01\x07\x01\x07\xf2\x01\x00", 1000, "reports invalid properties"),
        (0xDD, b"\xff", 1000, "its list does not run though it was started"),
        (0xFD, b"\xff\x00\x04\x00\x00\x00", 1000, "locked by seed and key"),
    ],
)
def test_wrong_answers_are_named(tmp_path: Path, command, answer: bytes, times: int, said: str) -> None:
    prepare("ram-answers", refusing(command, answer, times))
    outcome = run(tmp_path, "ram-answers", "[{wait: {duration_s: 0.1}}]")
    assert (outcome.error is None) == (said == ""), outcome.error
    assert said in str(outcome.error)
    assert outcome.result.safe_state == "confirmed"


def test_the_doctor_asks_and_leaves_nothing_behind() -> None:
    found = examine_bench(DoctorRequest(bench("ram-doctor"), 0.3))
    assert found.devices["devices.ram"].answers
    assert found.devices["devices.ram"].facts["software"] == "RMCU 1.0.0 DA2024A"
    assert found.verdict == "fine"
    prepare("ram-sick", refusing(0xFF, b""))
    found = examine_bench(DoctorRequest(bench("ram-sick"), 0.3))
    assert any("no answer to CONNECT" in finding.what for finding in found.findings)
