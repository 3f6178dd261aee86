"""Curves of given recordings, and of models that their torque drives: no peak lost, gaps as defined."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.engine.bench.bench_file import shipped
from hil.plant import replay, simulate
from hil.service.worker_pool.recording_curves import measured, simulated
from tests.hil.service.recordings.test_given_recordings import excited_csv

_MODEL = shipped("three_inertia.toml")


def test_a_curve_has_each_peak_in_its_bucket(tmp_path: Path) -> None:
    path = excited_csv(tmp_path / "a.csv")
    whole = measured(str(path), ["motor_torque_ref_nm"], None, None, 50)
    recording = read_recording(path)
    (curve,) = whole["curves"]
    assert max(curve["highest"]) == pytest.approx(np.max(recording["motor_torque_ref_nm"]), rel=1e-5)
    assert (curve["unit"], len(curve["lowest"]), whole["start_s"]) == ("N m", 50, 0.0)
    part = measured(str(path), ["motor_torque_ref_nm"], 2.0, 2.5, 4000)
    assert part["width_s"] == pytest.approx(0.001)
    inside = recording["motor_torque_ref_nm"][2000:2500]
    np.testing.assert_allclose(part["curves"][0]["lowest"][:500], inside, rtol=1e-5, atol=1e-6)
    with pytest.raises(BadInputError, match="has no channel 'none'"):
        measured(str(path), ["none"], None, None, 50)
    with pytest.raises(BadInputError, match="no data were measured in this period"):
        measured(str(path), ["motor_torque_ref_nm"], 20.0, 30.0, 50)


def test_the_gap_of_a_simulation_is_none_for_the_model_that_made_the_recording(tmp_path: Path) -> None:
    driven = read_recording(excited_csv(tmp_path / "a.csv"))
    # From rest, by itself: a replay's ripple follows the angles of what it replays.
    made = simulate(load_model(_MODEL), driven["motor_torque_ref_nm"], driven.sample_time_s)
    outputs = ["motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"]
    names = ["time_s", "motor_torque_ref_nm", *outputs]
    columns = [made[name] if name in outputs else driven[name] for name in names]
    path = tmp_path / "made.csv"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=",".join(names), comments="", fmt="%.9g")
    found = simulated(str(path), str(_MODEL), None, None, 100)
    gaps = {curve["channel"]: curve["gap"] for curve in found["curves"]}
    assert set(gaps) == set(outputs)
    assert max(gaps.values()) < 1e-5
    stiff = tmp_path / "stiff.toml"
    stiff.write_text(_MODEL.read_text("utf-8").replace("6089.0", "9000.0"), "utf-8")
    other = simulated(str(path), str(stiff), None, None, 100)
    changed = replay(load_model(stiff), read_recording(path))["shaft_torque_nm"]
    there = read_recording(path)["shaft_torque_nm"]
    expected = np.sqrt(np.mean((changed - there) ** 2)) / np.std(there)
    gap = next(curve["gap"] for curve in other["curves"] if curve["channel"] == "shaft_torque_nm")
    assert gap == pytest.approx(expected, rel=1e-6)
    assert gap > 0.01
