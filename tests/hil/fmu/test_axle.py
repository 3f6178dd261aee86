"""What a unit computes, against the kernel that analyses use and against a run on the simulated bench."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import test_plans
from hil.core.controller import load_controller
from hil.core.controller.shaping import RequestLimits, Schedule, SlipWithdrawal
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, load_model
from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bench_file import bench_from_dict
from hil.fmu import Axle
from hil.plant import simulate
from tests.benches_for_tests import SIM, plan

MODEL = load_model(SIM.simulation.model)
CONTROLLER = Path(test_plans.__file__).parent / "library" / "controllers" / "phase_stabilization.toml"
CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")


def stepped(axle: Axle, torque_nm: np.ndarray) -> dict[str, np.ndarray]:
    """Outputs at each millisecond, the torque of which is asked for from there on."""
    rows = []
    for asked in torque_nm:
        axle.torque_nm = float(asked)
        rows.append(axle.outputs())
        axle.step(1e-3)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def gap(found: np.ndarray, right: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - right) ** 2)) / np.sqrt(np.mean((right - right.mean()) ** 2)))


def test_without_a_controller_it_is_the_model_of_every_analysis() -> None:
    time_s = np.arange(0, 1.5, 1e-3)
    torque_nm = 15.0 * (time_s > 0.2) + 5.0 * np.sin(2 * np.pi * 7 * time_s)
    found = stepped(Axle(MODEL), torque_nm)
    right = simulate(MODEL, torque_nm, 1e-3)
    for name in CHANNELS:
        assert gap(found[name], right[name]) < 1e-6


def test_with_a_controller_it_is_the_simulated_bench(tmp_path: Path) -> None:
    data = tomllib.loads(SIM.text)
    data["name"] = "fmu"
    data["simulation"]["noise"] = dict.fromkeys(data["simulation"]["noise"], 0.0)
    for key, bus in data["buses"].items():
        bus["channel"] = f"fmu/{key}"
    steps = """[{set_controller: {file: phase_stabilization.toml}},
      {step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.5, after_s: 2}}]"""
    outcome = run_plan(RunRequest(plan(steps), bench_from_dict(data, SIM.text, SIM.source), tmp_path))
    assert outcome.error is None, outcome.error
    recording, (segment,) = read_recording(outcome.recording), outcome.result.segments
    rows = (recording.time_s >= segment.start_s) & (recording.time_s < segment.end_s)
    found = stepped(
        Axle(MODEL, load_controller(CONTROLLER)), recording.channels["driving_torque_ref_nm"][rows]
    )
    for name in (*CHANNELS, "vehicle_speed_m_s", "motor_torque_ref_nm"):
        assert gap(found[name], recording.channels[name][rows]) < 1e-3


def test_several_milliseconds_at_once_are_the_same() -> None:
    fine, coarse = Axle(MODEL), Axle(MODEL)
    fine.torque_nm = coarse.torque_nm = 10.0
    for _ in range(50):
        fine.step(1e-3)
    coarse.step(0.05)
    assert fine.outputs() == coarse.outputs()


def test_it_begins_at_its_speed() -> None:
    outputs = Axle(MODEL, initial_speed_m_s=5.0).outputs()
    assert outputs["vehicle_speed_m_s"] == pytest.approx(5.0, rel=0.01)
    assert outputs["wheel_speed_rad_s"] == pytest.approx(5.0 / 0.33, rel=0.02)


@pytest.mark.parametrize("step_s", [0.0, 5e-4, 1.5e-3, -1e-3])
def test_only_whole_milliseconds_pass(step_s: float) -> None:
    with pytest.raises(BadInputError, match="whole number of milliseconds"):
        Axle(MODEL).step(step_s)


def test_what_goes_beyond_fig_3_runs_in_a_unit_step_by_step() -> None:
    crossing = load_controller(CONTROLLER.with_name("play_crossing.toml"))
    tables = {
        "request": RequestLimits(rise_nm_s=20_000.0, fall_nm_s=30_000.0),
        "slip": SlipWithdrawal(allowed=0.3),
        "schedule": Schedule(speed_m_s=(0.0, 10.0), wsc_factor=(1.0, 0.8)),
    }
    model = MODEL.with_effects(*MODEL.effects, EffectUse("backlash", {"half_gap_rad": 0.02}))
    asked = np.repeat([-150.0, 300.0], [150, 150])
    found, once, lead = (
        Axle(model, controller, initial_speed_m_s=8.0)
        for controller in (*2 * (crossing.model_copy(update=tables),), load_controller(CONTROLLER))
    )
    rows, whole = stepped(found, asked), once.play(asked)
    for name, values in whole.items():
        np.testing.assert_array_equal(rows[name], values, err_msg=name)
    assert np.max(np.abs(whole["shaft_torque_nm"] - lead.play(asked)["shaft_torque_nm"])) > 50.0
