"""After a stop the axle is recorded as it runs down, every device safe, until it stands or for a time."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivers import Samples, Stream
from hil.core.errors import EmergencyStopError, InterruptError
from hil.core.recording import Recording, read_recording
from hil.engine import RunOutcome, RunRequest, run_plan
from hil.engine.bench.bench_tables import Supervision
from hil.engine.run import operator as operators
from hil.engine.run.run_down import AxleSpeeds, follow_run_down
from sim_backend.can_interface import attached
from tests.benches_for_tests import SIM, plan, running, sim_bench
from tests.hil.engine.cages import cage, shut
from tests.hil.engine.run.test_safety import Valve
from tests.operators import Silent

STEPS = """
  - hold_speed: {speed_km_h: 5, duration_s: 0.2}
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 10, before_s: 0.2, after_s: 2}
"""
PEAK = "[{segment: s, metric: peak, channel: motor_speed_rad_s, upper: 900, unit: rad/s}]"
SPEEDS = Stream("speeds", "bus 'x'", ("motor_speed_rad_s", "shaft_torque_nm"), ("rad/s", "N m"), 0.001)
STOP_S = 3.0


def stopped(tmp_path: Path, name: str, line: str = "e", again: str = "", **changes: Any) -> RunOutcome:
    """A run that is stopped while the axle turns, and perhaps once more a second later."""
    terminal = Silent()

    def read(now_s: float) -> float:
        for at_s, typed in ((STOP_S, line), (STOP_S + 1.0, again)):
            if typed and at_s <= now_s < at_s + 0.01:
                terminal.waiting.append(typed)
        return 1.0

    end = changes.pop("end", "[]")
    file = sim_bench(name, devices=cage(read), interlocks=shut(), **changes)
    return run_plan(RunRequest(plan(STEPS, PEAK, end), file, tmp_path, terminal=terminal))


def run_down_s(recording: Recording) -> float:
    """From the first of the two events of the run-down to the end of the rows."""
    begins = next(event for event in recording.events if event.kind == "run_down")
    return float(recording.time_s[-1]) - begins.time_s


def words(recording: Recording) -> list[str]:
    return [event.text for event in recording.events if event.kind == "run_down"]


@pytest.mark.parametrize(("line", "error"), [("e", EmergencyStopError), ("q", InterruptError)])
def test_the_axle_is_recorded_for_a_time_after_a_stop_without_torque(
    line: str, error: type, tmp_path: Path
) -> None:
    outcome = stopped(tmp_path, f"down-{line}", line)
    assert isinstance(outcome.error, error)
    assert outcome.result.safe_state == "confirmed"
    recording = read_recording(outcome.recording, allow_missing=True)
    begins, ends = words(recording)
    assert begins.startswith("begins, no device gives torque; the axle turns: motor_speed_rad_s reads")
    assert ends.startswith("ends after 10 s: not recorded any longer; the axle turns")  # a model without drag
    assert run_down_s(recording) == pytest.approx(10.0, abs=0.1)
    after = recording.time_s > recording.time_s[-1] - 9.5
    assert not np.any(recording["motor_torque_ref_nm"][after])
    assert not np.any(recording["dyno_torque_ref_nm"][after])
    kinds = [event.kind for event in recording.events]
    assert kinds.index("safe_state") < kinds.index("run_down")


def test_it_changes_neither_segments_nor_criteria_nor_limits(tmp_path: Path) -> None:
    short = stopped(tmp_path / "short", "down-none", supervision=Supervision(run_down_s=0.0))
    long = stopped(tmp_path / "long", "down-long", supervision=Supervision(run_down_s=30.0))
    assert words(read_recording(short.recording, allow_missing=True)) == []
    assert run_down_s(read_recording(long.recording, allow_missing=True)) == pytest.approx(30.0, abs=0.1)
    for name in ("verdict", "safe_state", "criteria", "segments", "limits", "reason", "end_steps"):
        assert getattr(short.result, name) == getattr(long.result, name), name
    assert short.largest == long.largest


def test_an_axle_that_stands_is_not_waited_for(tmp_path: Path) -> None:
    outcome = stopped(tmp_path, "down-stands", "q", end="[{ramp_down: {duration_s: 1.0}}]")
    assert isinstance(outcome.error, InterruptError)
    assert words(read_recording(outcome.recording, allow_missing=True)) == []


def test_a_service_that_ends_does_not_wait_for_it(tmp_path: Path) -> None:
    outcome = stopped(tmp_path, "down-gone", "\x04")
    assert isinstance(outcome.error, InterruptError)
    assert words(read_recording(outcome.recording, allow_missing=True)) == []


def test_it_ends_when_the_axle_stands(tmp_path: Path) -> None:
    """Drag slows the axle down as v exp(-t/τ): from 63 rad/s to 0.5 rad/s within 4.9 τ."""
    model = tmp_path / "drag.toml"
    text = (SIM.source.parent / "three_inertia.toml").read_text()
    model.write_text(text + '\n[[effects]]\nid = "viscous_drag"\ncoefficient_nms_rad = 0.5\n')
    simulation = SIM.simulation.model_copy(update={"model": str(model)})
    outcome = stopped(tmp_path / "out", "down-drag", simulation=simulation)
    recording = read_recording(outcome.recording, allow_missing=True)
    assert words(recording)[1].endswith("s: the axle stands")
    assert 0.3 < run_down_s(recording) < 9.0
    assert abs(recording["motor_speed_rad_s"][-1]) < 0.6


@pytest.mark.parametrize("again", ["e", "q", "\x04"])
def test_a_second_stop_ends_it_at_once(again: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operators, "SAME_STOP_S", 0.0)
    outcome = stopped(tmp_path, f"down-again-{ord(again)}", again=again)
    recording = read_recording(outcome.recording, allow_missing=True)
    assert "stopped once more" in words(recording)[1]
    assert run_down_s(recording) == pytest.approx(1.0, abs=0.15)
    assert outcome.result.safe_state == "confirmed"


def test_the_same_stop_by_another_way_does_not_end_it(tmp_path: Path) -> None:
    outcome = stopped(tmp_path, "down-same", again="e")  # virtual time: less than a second has passed
    assert run_down_s(read_recording(outcome.recording, allow_missing=True)) == pytest.approx(10.0, abs=0.1)


def test_an_emergency_stop_after_a_trip_ends_it_and_is_latched(tmp_path: Path) -> None:
    limits = SIM.limits.model_copy(update={"motor_speed_rad_s": 20.0})
    outcome = stopped(tmp_path, "down-trip", line="", again="e", limits=limits)
    assert isinstance(outcome.error, EmergencyStopError)
    assert outcome.result.emergency_stop is not None
    assert outcome.result.emergency_stop.latched
    assert words(read_recording(outcome.recording, allow_missing=True))[1].endswith("interrupted")


class Opening(Valve):
    """Is closed, opens once, and closes again when told to, or never."""

    def __init__(self, *, closes: bool) -> None:
        super().__init__(within_s=0.1)
        self._closes, self.open_from = closes, 10

    def is_safe(self) -> bool:
        self.asked += 1
        return self.asked < self.open_from or (self._closes and self.told > 0)


def made_safe_while_turning(bench: Any) -> None:
    bench.dyno.enable(20.0)
    bench.dyno.hold_speed(10.0)
    bench.loop.run_for(1.0)
    bench.dyno.make_safe()
    bench.rmcu.make_safe()
    assert bench.loop.wait_for(bench.dyno.is_safe, 0.5)


@pytest.mark.parametrize("closes", [True, False])
def test_a_device_that_leaves_its_safe_state_is_commanded_again_and_told_of(closes: bool) -> None:
    with running(f"down-leaves-{closes}") as bench:
        made_safe_while_turning(bench)
        valve = bench.further["valve"] = Opening(closes=closes)
        told: list[str] = []
        complaints = followed(bench, 1.0, lambda kind, text: told.append(text))
        assert valve.told > 0
        assert bench.rmcu.is_safe()
        assert bench.dyno.is_safe()
        if closes:
            assert complaints == []
            assert told[1].startswith("ends after 1 s: not recorded any longer")
        else:
            said = "valve did not confirm its safe state within 0.1 s"
            assert complaints == [f"{said}, while the axle ran down"]
            assert told[1].endswith(said)


def followed(bench: Any, longest_s: float, event: Callable[[str, str], None]) -> list[str]:
    speeds = AxleSpeeds(bench.streams, bench.loop.clock.now_s)

    def take() -> None:
        for source in bench.sources:
            for samples in source.samples():
                speeds.take(samples)

    bench.loop.shielded = True
    bench.loop.on_drained(take)
    return follow_run_down(bench, speeds, longest_s, lambda error: None, event)


def test_speeds_of_which_nothing_comes_are_not_waited_for() -> None:
    with running("down-silent") as bench:
        made_safe_while_turning(bench)
        clock, told = bench.loop.clock, []
        speeds = AxleSpeeds([SPEEDS], clock.now_s)
        speeds.take(Samples(SPEEDS, np.zeros(1), np.array([[30.0, 0.0]])))
        began_s = clock.now_s()
        follow_run_down(bench, speeds, 9.0, lambda error: None, lambda kind, text: told.append(text))
        assert told[1].endswith("the speed is no longer measured")
        assert clock.now_s() - began_s == pytest.approx(0.5, abs=0.05)
        assert attached("down-silent").rmcu.mode == 0


def test_rest_is_every_speed_below_half_a_rad_per_s_for_a_while_and_an_unknown_one_is_none() -> None:
    now_s = 0.0
    speeds = AxleSpeeds([SPEEDS], lambda: now_s)

    def take(at_s: float, speed: float) -> None:
        nonlocal now_s
        now_s = at_s
        speeds.take(Samples(SPEEDS, np.array([at_s]), np.array([[speed, 50.0]])))

    assert not speeds.stands
    take(0.1, 3.0)
    assert speeds.turns == "the axle turns: motor_speed_rad_s reads 3 rad/s"
    take(0.2, 0.1)
    assert (speeds.turns, speeds.stands) == ("", False)
    take(0.25, -0.7)  # it swings back
    take(0.44, 0.0)
    assert not speeds.stands
    take(0.46, 0.0)
    assert speeds.stands
    take(0.9, math.nan)
    take(1.0, math.nan)
    assert speeds.silent
