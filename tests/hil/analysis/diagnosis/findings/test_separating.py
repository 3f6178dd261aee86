"""Two effects that the data cannot tell apart, and the plan that can."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.findings.separating import _WORDS, Most, _outputs, _test, separating_plan
from hil.core.channels import OUTPUTS, unit_of
from hil.core.model import EffectUse, Model, save_model
from hil.core.recording import driven_by_torque, read_recording, write_recording
from hil.engine import RunRequest, run_plan
from hil.plant import Start, simulate
from test_plans import load_plan
from test_plans.steps import SAMPLE_TIME_S
from tests.benches_for_tests import sim_bench
from tests.hil.analysis.diagnosis.reference_plant import BASE, Truth, recordings

MODEL = Model("three_inertia", dict(BASE))
NOISE = np.array([0.1, 0.02, 1.0])
NAMES = ("actuator_lag", "dead_time")
HIL = Path(sys.executable).parent / "hil"
FRICTION = EffectUse("coulomb_friction", {"torque_nm": 1.0, "stribeck_torque_nm": 0.0, "offset_nm": 0.0})
ROLLING = EffectUse("running_resistance", {"rolling_nm": 20.0, "aero_nms2_rad2": 0.0})


def _most(torque_nm: float) -> Most:
    """What a bench allows that gives such a torque."""
    return Most(torque_nm, 40.0, 2.5 * BASE["gear_ratio"] * torque_nm)


def hil(*arguments: object, cwd: Path) -> None:
    done = subprocess.run([HIL, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_separating_test_is_a_plan_that_loads(tmp_path: Path) -> None:
    lag = MODEL.with_effects(EffectUse("actuator_lag", {"time_constant_s": 0.004}))
    delay = MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.004}))
    words, text = separating_plan(lag, delay, NOISE, _most(30.0), NAMES)
    found = re.search(r"differ by ([\d.e+-]+) (\S.*) rms in (\w+), (.+) times its noise in a sample", words)
    assert found is not None
    column = OUTPUTS.index(found[3])
    assert found[2] == unit_of(found[3])
    assert float(found[1]) == pytest.approx(float(found[4]) * NOISE[column], rel=0.02)
    (tmp_path / "plan.yaml").write_text(text)
    assert load_plan(tmp_path / "plan.yaml").name == "separate_actuator_lag_dead_time"


def test_no_test_is_proposed_that_could_not_tell() -> None:
    lag = MODEL.with_effects(EffectUse("actuator_lag", {"time_constant_s": 2e-4}))
    later = MODEL.with_parameters(torque_delay=BASE["torque_delay"] + 2e-4, shaft_stiffness=6095.0)
    words, text = separating_plan(lag, later, NOISE, _most(20.0), NAMES)
    assert "no test of ours tells them apart" in words
    assert text == ""


@pytest.mark.parametrize(
    ("one", "other", "chosen"),
    [
        (
            FRICTION,
            EffectUse("running_resistance", {"rolling_nm": 8.148, "aero_nms2_rad2": 0.0}),
            "standstill",
        ),
        (
            EffectUse("viscous_drag", {"coefficient_nms_rad": 0.01}),
            EffectUse("running_resistance", {"rolling_nm": 0.0, "aero_nms2_rad2": 0.044}),
            "coast-down",
        ),
    ],
)
def test_the_test_fits_what_it_shall_tell_apart(one: EffectUse, other: EffectUse, chosen: str) -> None:
    speeds = np.array([0.1, 0.02, np.nan])  # no shaft torque measured
    words, _ = separating_plan(MODEL.with_effects(one), MODEL.with_effects(other), speeds, _most(20.0), NAMES)
    assert chosen in words


def test_both_models_keep_the_limits_that_were_given() -> None:
    stiff = MODEL.with_parameters(shaft_stiffness=9000.0)
    for most in (Most(150.0, 40.0, 600.0), Most(60.0, 15.0, 1200.0)):
        torque, speed, shaft = most
        _, text = separating_plan(MODEL, stiff, NOISE, most, NAMES)
        test = next(
            t
            for n in _WORDS
            for s in (1.0, 0.6, 0.35, 0.2)
            if (t := _test(n, s * torque, NAMES)).text == text
        )
        for model in (MODEL, stiff):
            out = simulate(model, test.torque, 1e-3, Start(test.speed * BASE["gear_ratio"], test.speed))
            assert np.max(np.abs(out["wheel_speed_rad_s"])) <= speed
            assert np.max(np.abs(out["shaft_torque_nm"])) <= shaft


@pytest.mark.parametrize("name", _WORDS)
def test_models_side_by_side_show_what_each_shows_alone(name: str) -> None:
    test = _test(name, 30.0, NAMES)
    friction = MODEL.with_effects(FRICTION)
    for model, shown, share in zip(
        (MODEL, friction), _outputs(test, (MODEL, friction)), (1e-8, 5e-3), strict=True
    ):
        start = Start(test.speed * BASE["gear_ratio"], test.speed, 0.0, 0.0)
        alone = simulate(model, test.torque, SAMPLE_TIME_S, start)
        for channel, values in zip(OUTPUTS[:2], shown.T, strict=False):
            assert values == pytest.approx(alone[channel], abs=share * np.max(np.abs(alone[channel])))


@pytest.mark.slow
@pytest.mark.parametrize("name", _WORDS)
def test_every_test_runs_on_the_simulated_bench_as_it_was_simulated(name: str, tmp_path: Path) -> None:
    test = _test(name, 30.0, NAMES)
    outcome = run_plan(RunRequest(test.plan, sim_bench(name), tmp_path, MODEL))
    assert (outcome.error, outcome.result.verdict, outcome.result.safe_state) == (None, "done", "confirmed")
    (part,) = driven_by_torque(read_recording(outcome.recording))
    simulated = simulate(MODEL, test.torque, 1e-3, Start(test.speed * BASE["gear_ratio"], test.speed))
    for channel, share in (("motor_speed_rad_s", 0.05), ("wheel_speed_rad_s", 0.05)):
        size = min(len(part[channel]), len(test.torque))
        difference = part[channel][:size] - simulated[channel][:size]
        assert np.std(difference) < share * np.max(np.abs(simulated[channel]))


@pytest.mark.hunt
def test_what_one_way_turning_leaves_open_the_plan_decides(tmp_path: Path) -> None:
    """Friction and running resistance on an axle that only turns forward, without a shaft torque sensor."""
    (recording,) = recordings(Truth({"rolling": 20.0}), 2, off=0.0, short=True, only=("chirp_biased",))
    del recording.channels["shaft_torque_nm"]
    write_recording(recording, tmp_path / "biased.csv")
    save_model(MODEL, tmp_path / "model.toml")
    hil("diagnose", "--model", "model.toml", "biased.csv", "--out", "why", cwd=tmp_path)
    first = json.loads((tmp_path / "why/diagnosis.json").read_text())
    likely = {e["id"]: e for e in first["effects"]} | {
        a["id"]: a for a in first["alternatives"] if "plan" in a
    }
    assert {"coulomb_friction", "running_resistance"} <= set(likely)
    (named,) = first["effects"]
    assert {"coulomb_friction", "running_resistance"} <= {*named["class"].split(" or ")}
    plan = next(a["plan"] for a in first["alternatives"] if "plan" in a)

    save_model(MODEL.with_effects(ROLLING), tmp_path / "axle.toml")
    hil("run", f"why/{plan}", "--model", "axle.toml", "--out", "test", cwd=tmp_path)
    assert json.loads((tmp_path / "test/result.json").read_text())["verdict"] == "done"

    hil(
        "diagnose", "--model", "model.toml", "biased.csv", "test/recording.mcap", "--out", "now", cwd=tmp_path
    )
    second = json.loads((tmp_path / "now/diagnosis.json").read_text())
    assert [e["id"] for e in second["effects"]] == ["running_resistance"]
    assert second["effects"][0]["confidence"] > 0.85
    assert not any("plan" in a for a in second["alternatives"])
