"""A run is judged by when its samples were taken, not by when an adapter stamped their frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.recording import Recording, read_frames, read_recording
from hil.core.result import RunResult
from hil.engine import RunRequest, run_plan
from hil.engine.ipc.ipc import RECORDING
from test_plans import Plan, load_plan
from tests.benches_for_tests import plan, sim_bench
from tests.late_stamps import late_bench

LATE = ["bursts", "pauses", "outliers"]
STEPS = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.3}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.2, after_s: 2}
"""
CRITERIA = """
  - {segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}
  - {segment: s, metric: band_energy_motor_speed, from_s: 0.5, to_s: 2.0, upper: 50}
"""


def carried_out(a_plan: Plan, bench: object, out: Path) -> tuple[RunResult, Recording]:
    outcome = run_plan(RunRequest(a_plan, bench, out))  # type: ignore[arg-type]
    assert outcome.error is None
    return outcome.result, read_recording(outcome.recording)


def compare(result: RunResult, recording: Recording, true: RunResult, truth: Recording) -> None:
    """Every figure within 1 %, as long as it was, every row where it was, nearly every value in its row."""
    assert recording.time_s[-1] == truth.time_s[-1]
    np.testing.assert_array_equal(recording.time_s, truth.time_s)
    for found, right in zip(result.criteria, true.criteria, strict=True):
        assert found.verdict == right.verdict
        if found.id.endswith(
            "stability_oscillation"
        ):  # what is left of T_s: next to nothing, and as uncertain
            continue
        assert found.value == (right.value if right.value is None else pytest.approx(right.value, rel=0.01))
    for name, values in truth.channels.items():
        same = recording[name] == values
        assert np.mean(same | np.isnan(values)) > 0.995, name


@pytest.fixture(scope="module")
def true_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Recording]:
    out = tmp_path_factory.mktemp("true")
    return carried_out(plan(STEPS, CRITERIA), sim_bench("true"), out)


@pytest.mark.parametrize("late", LATE)
def test_late_stamps_change_no_figure(
    late: str, true_run: tuple[RunResult, Recording], tmp_path: Path
) -> None:
    result, recording = carried_out(plan(STEPS, CRITERIA), late_bench(f"late_{late}", late), tmp_path)
    compare(result, recording, *true_run)
    assert max(clock.latest_s for clock in result.clocks) > (0.0009 if late == "bursts" else 0.02)
    assert all(abs(clock.drift_ppm) < 100 for clock in result.clocks)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 11))
def test_which_stamps_are_outliers_changes_no_figure(
    seed: int, true_run: tuple[RunResult, Recording], tmp_path: Path
) -> None:
    late = late_bench(f"late_{seed}", "outliers", seed)
    compare(*carried_out(plan(STEPS, CRITERIA), late, tmp_path), *true_run)


def test_with_stamps_as_they_should_be_the_clocks_agree(true_run: tuple[RunResult, Recording]) -> None:
    result, recording = true_run
    base, *others = result.clocks
    assert base.stream.startswith("frame 0x110")
    assert base.counted_by == "8 bits in RMCU_Control"
    assert {clock.counted_by for clock in others} == {"8 bits in RMCU_Control", "SYNC frames"}
    for clock in result.clocks:
        assert abs(clock.offset_s) < 0.0005
        assert abs(clock.drift_ppm) < 0.1
        assert (clock.lost, clock.left_out) == (0, 0)
    assert recording.metadata["time"]["bench_clock_s_per_time_s"] == "1.0000000"


def test_raw_frames_keep_their_stamps_and_the_file_says_where_the_rows_lie(tmp_path: Path) -> None:
    _, recording = carried_out(plan(STEPS, CRITERIA), late_bench("kept", "bursts"), tmp_path)
    frames = read_frames(tmp_path / RECORDING)["rmcu"]
    status = frames[frames["id"] == 0x110]
    np.testing.assert_allclose(status["time_s"] / 0.002, np.rint(status["time_s"] / 0.002), atol=1e-6)
    speeds = (status["data"] >> np.uint64(4) & np.uint64(0x3FFFFF)).astype(np.int64)
    speeds[speeds >= 1 << 21] -= 1 << 22
    shown = np.rint(recording["motor_speed_rad_s"][:50] / 0.001).astype(np.int64)
    (row_0,) = (at for at in range(len(speeds) - 50) if np.array_equal(speeds[at : at + 50], shown))
    row_0_s = float(recording.metadata["time"]["bench_clock_at_row_0_s"])
    assert abs(status["time_s"][row_0] - row_0_s) <= 0.002


@pytest.mark.parametrize(
    "late",
    [
        pytest.param("bursts", marks=pytest.mark.slow),
        pytest.param("pauses", marks=pytest.mark.hunt),
        pytest.param("outliers", marks=pytest.mark.slow),
    ],
)
def test_the_acceptance_figures_stay_what_they_are(late: str, tmp_path: Path) -> None:
    acceptance = load_plan("acceptance")
    truth = carried_out(acceptance, sim_bench("right"), tmp_path / "true")
    result, recording = carried_out(acceptance, late_bench("late", late), tmp_path / "late")
    compare(result, recording, *truth)
