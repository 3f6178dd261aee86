"""A run whose sensors are dead, half, mirrored or frozen cannot pass, whatever limits its criteria have."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hil.core.can.frames import FrameBlock
from hil.core.channels import TICK_S
from hil.core.errors import BenchError
from hil.core.recording import read_recording
from hil.engine import RunOutcome, RunRequest, run_plan
from hil.plant.closed_loop import tick as T
from sim_backend.bench import DYNO_BUS, RMCU_BUS, SensorFault, SimulatedBench
from sim_backend.can_interface import prepare
from test_plans import rejudged
from tests.benches_for_tests import plan, sim_bench
from tests.faults import injecting

STEPS = """[{set_controller: {file: phase_stabilization.toml}},
  {hold_speed: {speed_km_h: 10, duration_s: 0.5}},
  {step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.5, after_s: 4}}]"""
CRITERIA = "[{segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}]"
LEFT, RIGHT = "shaft_torque_left_nm", "shaft_torque_right_nm"


def ran(name: str, place: Path, faults: dict[str, SensorFault]) -> RunOutcome:
    def spoiled(world: SimulatedBench) -> None:
        for channel, fault in faults.items():
            world.spoil(channel, fault)

    prepare(name, spoiled)
    return run_plan(RunRequest(plan(STEPS, CRITERIA), sim_bench(name), place))


def test_with_sound_sensors_it_passes(tmp_path: Path) -> None:
    outcome = ran("sound-sensors", tmp_path, {})
    assert outcome.result.verdict == "pass"
    assert {c.source for c in outcome.result.criteria} == {"plan", "device"}


@pytest.mark.parametrize(
    ("faults", "doubted"),
    [
        ({LEFT: SensorFault(gain=0.0), RIGHT: SensorFault(gain=0.0)}, "shaft_torque_nm reads zero"),
        ({LEFT: SensorFault(gain=0.5), RIGHT: SensorFault(gain=0.5)}, "shaft_torque_nm is 0.49"),
        ({LEFT: SensorFault(gain=0.0)}, "shaft_torque"),
        ({RIGHT: SensorFault(gain=-1.0)}, "shaft_torque"),
    ],
    ids=["both dead", "both half", "one dead", "one mirrored"],
)
def test_with_a_blind_sensor_it_does_not(
    faults: dict[str, SensorFault], doubted: str, tmp_path: Path
) -> None:
    name = f"blind-{len(faults)}-{next(iter(faults.values())).gain:g}-{next(iter(faults))}"
    outcome = ran(name, tmp_path, faults)
    peak = outcome.result.criteria[0]
    assert (outcome.result.verdict, peak.verdict, peak.value) == ("error", "error", None)
    assert doubted in peak.reason
    again = rejudged(read_recording(outcome.recording))
    assert again is not None
    assert again.criteria == outcome.result.criteria


class Freezes:
    """Changes the dynos' frames from 20 ms after the first torque on; the bus goes on."""

    def __init__(self, change: Callable[[FrameBlock], FrameBlock]) -> None:
        self._change = change
        self._from_s = np.inf

    def time_passes(self, now_s: float) -> None:
        """Nothing to do."""

    def to_nodes(self, bus: str, frame_id: int, data: bytes) -> list[tuple[int, bytes]]:
        return [(frame_id, data)]

    def look(self, first: int, rows: np.ndarray) -> None:
        on = np.flatnonzero(np.abs(rows[:, T.TORQUE_REF]) > 1e-6)
        if len(on):
            self._from_s = min(self._from_s, (first + on[0]) * TICK_S + 0.02)

    def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
        late = bus == DYNO_BUS and len(block) and block["time_s"][0] >= self._from_s
        return self._change(block) if late else block


@pytest.mark.parametrize(
    "frames", [(0x183, 0x184, 0x283, 0x284), (0x184, 0x284)], ids=["both sides", "one side"]
)
def test_values_that_freeze_under_torque_end_the_run(frames: tuple[int, ...], tmp_path: Path) -> None:
    """From 20 ms after the first torque on, while the bus is alive."""
    name = f"frozen-{len(frames)}"
    prepare(name, lambda world: setattr(world, "tamper", Freezes(injecting.stuck(*frames))))
    outcome = run_plan(RunRequest(plan(STEPS, CRITERIA), sim_bench(name), tmp_path))
    assert isinstance(outcome.error, BenchError)
    assert "repeats bit for bit" in outcome.error.what
    segment = outcome.result.segments[0]
    assert segment.end_s - segment.step_s < 0.02 + 0.1 + 0.02  # a block of bus time on either side
    assert {c.verdict for c in outcome.result.criteria} == {"not_judged"}


def test_damaged_frames_are_left_out_and_named(tmp_path: Path) -> None:
    change = injecting.damaged(50)

    class Damages(Freezes):
        def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
            return change(block) if bus == RMCU_BUS else block

    prepare("damaged-frames", lambda world: setattr(world, "tamper", Damages(change)))
    outcome = run_plan(RunRequest(plan(STEPS, CRITERIA), sim_bench("damaged-frames"), tmp_path / "damaged"))
    sound = ran("undamaged", tmp_path / "sound", {})
    assert outcome.result.verdict == sound.result.verdict == "pass"
    assert any("are damaged (wrong checksum)" in text for text in outcome.result.missing)
    recording = read_recording(outcome.recording)
    limits = read_recording(sound.recording)
    for name in ("motor_speed_rad_s", "motor_torque_ref_nm", "motor_torque_nm"):
        assert np.max(np.abs(recording[name])) < 1.05 * np.max(np.abs(limits[name])) + 0.1
