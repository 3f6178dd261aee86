"""The whole loop with a bench in another process: an effect hidden there, a run over the wire, its name."""

import json
import subprocess

import pytest

from hil.core.model import load_model
from tests.hil.cli.test_commands import HIL
from tests.hil.cli.test_sim_bench import serving

MODEL = HIL.parents[2] / "benches/three_inertia.toml"
PLAN = """
name: chirps
steps:
  - hold_speed: {speed_km_h: 20, duration_s: 1}
  - chirp: {segment: c, quantity: motor_torque, from_hz: 0.3, to_hz: 30, duration_s: 12, amplitude_nm: 20}
  - hold_speed: {speed_km_h: 20, duration_s: 1}
  - chirp: {segment: d, quantity: motor_torque, from_hz: 0.3, to_hz: 30, duration_s: 12, amplitude_nm: 10}
finally:
  - ramp_down: {duration_s: 2}
"""


def run_on_a_bench_that_hides(tmp_path, hidden, plan, time_scales):
    """Recording of a plan, at the first pace that succeeds.

    A machine that stood still trips the RMCU, as it should; then it is tried again.
    """
    for attempt, time_scale in enumerate(time_scales):
        out = tmp_path / str(attempt)
        with serving(tmp_path, "--time-scale", time_scale, "--hide", hidden) as (_, file):
            command = [HIL, "run", plan, "--bench", file, "--out", out]
            done = subprocess.run(command, capture_output=True, text=True, timeout=2400, check=False)
        if done.returncode != 3:
            break
    assert done.returncode == 0, done.stderr
    return out / "recording.mcap"


def the_effect_that_is_named(tmp_path, recording):
    command = [HIL, "diagnose", "--model", MODEL, recording, "--out", tmp_path / "why", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=2400, check=True)
    told = json.loads(done.stdout)
    assert told["verdict"] == "named"
    (effect,) = told["effects"]
    return effect


@pytest.mark.slow
def test_what_a_bench_in_another_process_hides_is_named(tmp_path):
    (tmp_path / "chirps.yaml").write_text(PLAN)
    recording = run_on_a_bench_that_hides(
        tmp_path, "dead_time=0.002", tmp_path / "chirps.yaml", ["1", "0.4", "0.2", "0.2"]
    )
    effect = the_effect_that_is_named(tmp_path, recording)
    assert effect["parameters"]["parameter"] == "torque_delay"  # of the base: no effect of its own
    own_s = load_model(MODEL).parameters["torque_delay"]
    assert effect["parameters"]["value"] - own_s == pytest.approx(0.002, rel=0.03)


@pytest.mark.hunt  # minutes of searching: the loop itself is in the slow set, with dead time
def test_free_play_is_named_from_the_identification_plan_in_real_time(tmp_path):
    recording = run_on_a_bench_that_hides(
        tmp_path, "backlash=0.01", "identification", ["1", "1", "0.5", "0.2"]
    )
    effect = the_effect_that_is_named(tmp_path, recording)
    assert effect["id"] == "backlash"
    assert effect["parameters"]["half_gap_rad"] == pytest.approx(0.01, rel=0.03)
