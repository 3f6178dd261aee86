"""What steps ask for, executed on the simulated bench: torque, speed, segments, prompts, analyses."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.recording import Recording, read_recording
from hil.core.result import Segment
from hil.engine.run.recorder import Recorder
from hil.engine.run.step_execution import RELEASE_S, BenchConductor, release_from
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from test_plans import PlannedSegment
from tests.benches_for_tests import running

SEGMENT = PlannedSegment("s", "step", 0.05, 0.0, 12.0, "motor_torque", 0.3)


@dataclass
class Stage:
    bench: Any
    recorder: Recorder
    conductor: BenchConductor
    asked: list[str]

    def events(self) -> list[tuple[str, str]]:
        return [(event.kind, event.text) for event in self.recorder.events]


@contextlib.contextmanager
def stage(out: Path, name: str = "conductor") -> Iterator[Stage]:
    asked: list[str] = []

    def ask(text: str, timeout_s: float, picture: str) -> str:
        asked.append(text)
        return "yes"

    with running(name) as bench:
        recorder = Recorder(out / "r.mcap", bench.streams, list(bench.file.buses), 0.001)

        def take() -> None:
            for source in bench.sources:
                for samples in source.samples():
                    recorder.take(samples)

        try:
            bench.loop.on_drained(take)
            recorder.begin()
            bench.loop.run_for(0.05)
            bench.dyno.enable(10.0)
            yield Stage(bench, recorder, BenchConductor(bench, recorder, out, ask), asked)
        finally:
            recorder.writer.close()


def test_speed_is_reached_by_the_ramp_and_held(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        clock, file = one.bench.loop.clock, one.bench.file
        began_s = clock.now_s()
        one.conductor.hold_speed(2.0, 0.5)
        passed_s = clock.now_s() - began_s
        target = 2.0 / file.vehicle.wheel_radius_m
        assert one.bench.dyno.wheel_speed_rad_s == pytest.approx(target, abs=0.5)
        assert 2.0 / file.dyno.speed_ramp_m_s2 + 0.5 <= passed_s < 2.0 / file.dyno.speed_ramp_m_s2 + 1.5
        assert ("speed", "dynos hold 7.2 km/h") in one.events()


def test_wheels_that_do_not_turn_end_the_step(tmp_path: Path) -> None:
    with stage(tmp_path, "stuck") as one:
        attached("stuck").fail(Fault.DYNO_DEAF)
        with pytest.raises(BenchError):
            one.conductor.hold_speed(1.0, 0.1)


def test_samples_are_played_one_each_tick_and_released_in_the_end(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        began_s = one.bench.loop.clock.now_s()
        torque = np.where(np.arange(300) < 50, 0.0, 12.0)
        one.conductor.play("motor_torque", torque, SEGMENT)
        passed_s = one.bench.loop.clock.now_s() - began_s
        assert 0.3 + RELEASE_S <= passed_s < 0.3 + RELEASE_S + 0.2
        (segment,) = one.conductor.segments
        assert segment.complete
        assert segment.step_s - segment.start_s == pytest.approx(0.05)
        assert segment.end_s - segment.start_s == pytest.approx(0.3)
        assert (segment.reference_before, segment.reference_after) == (0.0, 12.0)
        assert (segment.controller, segment.load) == ("", "speed")
        assert one.bench.rmcu.is_safe()
        assert ("segment", "s begins") in one.events()


def test_each_segment_is_described_in_the_recording_as_it_ended(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        for name in ("s", "t"):
            one.conductor.play("motor_torque", np.zeros(300), replace(SEGMENT, id=name))
    tables = read_recording(tmp_path / "r.mcap", allow_missing=True).metadata
    stored = [Segment.model_validate_json(tables[f"segment/{name}"]["json"]) for name in ("s", "t")]
    assert [(segment.id, segment.complete) for segment in stored] == [("s", True), ("t", True)]


def test_torque_is_taken_away_evenly_within_its_time() -> None:
    assert len(release_from(0.0)) == 0
    samples = release_from(-8.0)
    assert len(samples) == round(RELEASE_S * 1000)
    assert (samples[0], samples[-1]) == (-8.0, 0.0)
    assert np.diff(samples) == pytest.approx(8.0 / (len(samples) - 1))


def test_what_ends_at_no_torque_needs_no_release(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        began_s = one.bench.loop.clock.now_s()
        one.conductor.play("motor_torque", np.zeros(100), None)
        assert one.bench.loop.clock.now_s() - began_s < 0.2
        assert one.conductor.segments == []


def test_a_segment_that_is_broken_off_ends_where_it_was(tmp_path: Path) -> None:
    with stage(tmp_path, "broken") as one:
        began_s = one.bench.loop.clock.now_s()
        world = attached("broken")

        def break_off() -> None:
            if one.bench.loop.clock.now_s() - began_s > 0.1:
                world.fail(Fault.RMCU_SILENT)
                raise KeyboardInterrupt

        one.bench.loop.on_drained(break_off)
        with pytest.raises(KeyboardInterrupt):
            one.conductor.play("motor_torque", np.full(300, 5.0), SEGMENT)
        (segment,) = one.conductor.segments
        assert not segment.complete
        assert segment.start_s + 0.09 < segment.end_s < segment.start_s + 0.12


def test_the_operator_is_asked_with_torque_off_and_both_stand_in_the_recording(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        one.conductor.prompt("clear?")
        assert one.asked == ["clear?"]
        assert [text for kind, text in one.events() if kind == "prompt"] == ["clear?", "yes"]
        assert one.bench.rmcu.is_safe()


def test_the_load_is_the_vehicle_from_its_release_on(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        one.conductor.hold_speed(1.0, 0.0)
        one.conductor.release_vehicle()
        one.conductor.play("motor_torque", np.zeros(300), SEGMENT)
        (segment,) = one.conductor.segments
        assert segment.load == "vehicle"
        assert segment.initial_speed_km_h == pytest.approx(3.6)
        one.conductor.ramp_down(0.1)
        assert one.bench.dyno.wheel_speed_rad_s == pytest.approx(0.0, abs=0.5)


def test_waiting_and_coasting_take_their_time(tmp_path: Path) -> None:
    with stage(tmp_path) as one:
        for step in (one.conductor.wait, one.conductor.coast):
            began_s = one.bench.loop.clock.now_s()
            step(0.2)
            assert one.bench.loop.clock.now_s() - began_s == pytest.approx(0.2, abs=0.05)


def test_an_analysis_sees_the_run_so_far_and_its_files_are_whole(tmp_path: Path) -> None:
    def work(recording: Recording, out: Path) -> dict[str, bytes]:
        assert out == tmp_path
        assert b'"id":"s"' in recording.attachments["run.json"]
        return {"found.txt": str(len(recording.time_s)).encode(), "another.txt": b"1"}

    with stage(tmp_path) as one:
        one.conductor.play("motor_torque", np.zeros(300), SEGMENT)
        one.conductor.analyse("look", work, ("found.txt", "another.txt"))
        assert int((tmp_path / "found.txt").read_text()) >= 300
        assert one.conductor.made["another.txt"] == b"1"
        assert one.events()[-1] == ("analysis", "look: another.txt, found.txt")


def test_a_controller_is_kept_once_and_named(tmp_path: Path) -> None:
    shipped = Path(__file__).parents[4] / "test_plans/library/controllers/phase_stabilization.toml"
    with stage(tmp_path) as one:
        for _ in range(2):
            one.conductor.set_controller(shipped)
        assert list(one.conductor.controllers) == ["phase_stabilization"]
        assert [kind for kind, _ in one.events()].count("controller") == 2
        assert "phase stabilization" in one.events()[-1][1]


def test_the_bench_files_limits_lie_below_every_step(tmp_path: Path) -> None:
    with stage(tmp_path) as one, pytest.raises(BadInputError):
        one.conductor.hold_speed(500.0, 0.1)
