"""From an open bench to an armed one: what refuses it, and from when on the safe state is owed."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivers import Connections, Device, DeviceTable
from hil.core.errors import BenchError, EmergencyStopError
from hil.core.recording import read_recording
from hil.engine.bench.bench import open_bench
from hil.engine.bench.bench_tables import ZeroLimit
from hil.engine.ipc.ipc import Terminal
from hil.engine.run.arming import Arming
from hil.engine.run.operator import Operator
from hil.engine.run.recorder import Recorder
from hil.engine.run.run_monitoring import RunMonitoring
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import sim_bench
from tests.hil.engine.cages import Cage, cage, shut


@dataclass
class Stage:
    bench: Any
    recorder: Recorder
    watch: RunMonitoring
    arming: Arming
    path: Path


@contextlib.contextmanager
def stage(out: Path, name: str, terminal: Terminal | None = None, **changes: Any) -> Iterator[Stage]:
    """An open bench of which nothing has been asked yet."""
    with open_bench(sim_bench(name, **changes)) as bench:
        recorder = Recorder(out / "r.mcap", bench.streams, list(bench.file.buses), 0.001)

        def event(kind: str, text: str) -> None:
            recorder.event(bench.loop.clock.now_s(), kind, text)

        watch = RunMonitoring(bench, recorder, Operator(bench.loop, terminal, ""), event)
        try:
            arming = Arming(bench, recorder, watch.limits, watch.zero, None)
            yield Stage(bench, recorder, watch, arming, out / "r.mcap")
        finally:
            recorder.writer.close()


def test_an_armed_bench_stands_still_is_watched_and_its_sensors_have_been_read(tmp_path: Path) -> None:
    with stage(tmp_path, "arms") as at:
        assert (at.arming.armed, at.watch.limits.active) == (False, False)
        at.arming.come_up()
        assert (at.arming.armed, at.watch.limits.active) == (True, True)
        at.bench.loop.run_for(0.1)
        assert at.bench.rmcu.state == "off"
        assert abs(at.bench.dyno.wheel_speed_rad_s) < 0.1
        assert not at.bench.dyno.is_safe()  # its drives are on
        assert [node.power.state.name == "OPERATION_ENABLED" for node in attached("arms").dynos] == [
            True,
            True,
            False,
            False,
        ]
        assert {zero.channel for zero in at.watch.zero.zeros} >= {"motor_speed_rad_s"}
        assert [event.kind for event in at.recorder.events] == ["preflight", "arm"]
        assert at.recorder.events[0].text == f"{at.arming.names} answer"
        assert {identity.device for identity in at.arming.identities} == {"rmcu", "dyno"}
        assert at.arming.missing == ()
        at.recorder.finish_rows()
    times_s = read_recording(at.path).time_s
    assert np.allclose(np.diff(times_s), 1e-3)


@pytest.mark.parametrize(
    ("changes", "fault", "said", "where", "owed"),
    [
        ({}, Fault.RMCU_SILENT, "sends no status", "RMCU", False),
        ({}, Fault.DYNO_SILENT, "no answer within 0.3 s while object 0x1600 was read", "rear left", False),
        ({"devices": cage(lambda s: 0.0), "interlocks": shut()}, None, "cage_shut", "interlock 'cage'", True),
        ({"zero": {"shaft_torque_left_nm": ZeroLimit(within=1e-9)}}, None, "at rest", "zero check", False),
    ],
)
def test_what_keeps_it_from_being_armed(
    changes: dict[str, Any], fault: Fault | None, said: str, where: str, owed: bool, tmp_path: Path
) -> None:
    with stage(tmp_path, "refused", **changes) as at:
        if fault:
            attached("refused").fail(fault)
        with pytest.raises(BenchError) as caught:
            at.arming.come_up()
        assert said in caught.value.what
        assert where in caught.value.where
        assert at.arming.armed is owed
        assert "arm" not in [event.kind for event in at.recorder.events]
        assert not any(node.power.state.name == "OPERATION_ENABLED" for node in attached("refused").dynos)


class Stubborn(Cage):
    """Comes up in a way of its own."""

    coming_up: Callable[[], None]

    def come_up(self) -> None:
        self.coming_up()


class StubbornTable(DeviceTable):
    kind: str = "cage"
    coming_up: Any

    def open(self, name: str, connections: Connections) -> Device:
        made = Stubborn(connections, lambda now_s: 1.0)
        made.coming_up = self.coming_up
        return made


def test_with_the_first_further_device_the_safe_state_is_owed(tmp_path: Path) -> None:
    def fails() -> None:
        raise BenchError("does not answer", where="oil")

    with stage(tmp_path, "further", devices={"oil": StubbornTable(coming_up=fails)}) as at:
        with pytest.raises(BenchError, match="does not answer"):
            at.arming.come_up()
        assert at.arming.armed


def test_an_old_fault_of_the_rmcu_is_left(tmp_path: Path) -> None:
    """Somebody's requests broke off under torque: it is in fault, with a count of its own."""
    with stage(tmp_path, "old") as at:
        loop, rmcu = at.bench.loop, at.bench.rmcu
        loop.run_for(0.1)
        for payload in rmcu.requests("motor_torque", np.full(5, 3.0)):
            rmcu.send(payload)
            loop.step()
        loop.run_for(0.2)
        assert (rmcu.state, rmcu.fault) == ("fault", "timeout")
        rmcu.take_back(7)  # another host, whose count begins elsewhere
        at.arming.come_up()
        loop.run_for(0.05)
        assert rmcu.state == "off"


def test_a_device_that_is_not_there_is_noted(tmp_path: Path) -> None:
    with stage(tmp_path, "gone") as at:
        at.bench.missing["oil"] = "no such port"
        at.arming.come_up()
        assert at.arming.missing == ("oil is missing: no such port",)
        assert ("missing", "oil is missing: no such port") in [(e.kind, e.text) for e in at.recorder.events]


def test_a_device_that_fell_silent_after_its_first_word_keeps_it_from_being_armed(tmp_path: Path) -> None:
    with stage(tmp_path, "silenced") as at:
        at.bench.loop.run_for(0.05)
        at.bench.loop.every(0.15, lambda: attached("silenced").fail(Fault.RMCU_SILENT))
        with pytest.raises(BenchError, match="sends no status|has stopped coming"):
            at.arming.come_up()
        assert not at.arming.armed


def test_no_drive_is_enabled_before_the_rmcu_says_that_it_is_off(tmp_path: Path) -> None:
    with stage(tmp_path, "on") as at:
        at.bench.rmcu.is_safe = lambda: False  # what it says cannot be believed
        with pytest.raises(BenchError, match="does not confirm that its torque is off: state 'off'"):
            at.arming.come_up()
        assert at.arming.armed
        assert not any(node.power.state.name == "OPERATION_ENABLED" for node in attached("on").dynos)


def test_a_stop_while_devices_say_who_they_are_is_no_device_that_does_not_answer(tmp_path: Path) -> None:
    with stage(tmp_path, "asks") as at:
        pressed = iter([True])

        def press() -> None:
            if next(pressed, False):
                raise EmergencyStopError("an emergency stop was pressed", by="a test")

        at.bench.loop.every(0.002, press)
        with pytest.raises(EmergencyStopError, match="was pressed"):
            at.bench.dyno.identify()
