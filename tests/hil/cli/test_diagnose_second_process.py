"""The whole loop with a bench in another process: an effect hidden there, a run over the wire, its name."""

import json
import subprocess

import pytest

from tests.hil.cli.test_commands import HIL, hil
from tests.hil.cli.test_sim_bench import MOST_REPEATS, serving

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


@pytest.mark.slow
def test_what_a_bench_in_another_process_hides_is_named(tmp_path):
    """At a fifth of real time; a machine that stood still trips the RMCU, and then it is tried again."""
    (tmp_path / "chirps.yaml").write_text(PLAN)
    for attempt in range(MOST_REPEATS):
        run = tmp_path / str(attempt)
        with serving(tmp_path, "--time-scale", "0.2", "--hide", "dead_time=0.002") as (_, file):
            command = [HIL, "run", tmp_path / "chirps.yaml", "--bench", file, "--out", run]
            done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
        if done.returncode != 3:
            break
    assert done.returncode == 0, done.stderr
    told = json.loads(
        hil("diagnose", "--model", MODEL, run / "recording.mcap", "--out", tmp_path / "why", "--json").stdout
    )
    assert told["verdict"] == "named"
    (effect,) = told["effects"]
    assert effect["id"] == "dead_time"
    assert effect["parameters"]["extra_delay_s"] == pytest.approx(0.002, rel=0.03)
