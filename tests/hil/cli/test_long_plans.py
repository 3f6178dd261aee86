"""What an hour and a day of a plan take: a limit on the memory of the process, as a supervisor sets one."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.hil.cli.test_commands import HIL

# Of data (`ulimit -d`): what the process writes to, not what its threads and libraries reserve.
_LIMIT_KB = 900_000
_HOUR = """
name: hour
steps:
  - set_controller: {file: phase_stabilization.toml}
  - repeat:
      times: TIMES
      steps:
        - hold_speed: {speed_km_h: 20, duration_s: 1780}
        - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 1, after_s: 5}
finally: [ramp_down: {duration_s: 0.2}]
criteria: [{segment: s_1, metric: peak_shaft_torque, upper: 300, unit: N m}]
"""


def within_limit(*arguments: object, timeout_s: float) -> str:
    """What a command prints that may use so much memory and no more."""
    words = [str(HIL), *map(str, arguments)]
    line = ["bash", "-c", f'ulimit -d {_LIMIT_KB}; exec "$@"', "bash", *words]
    done = subprocess.run(line, capture_output=True, text=True, timeout=timeout_s, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def hour(tmp_path: Path) -> Path:
    path = tmp_path / "hour.yaml"
    path.write_text(_HOUR.replace("TIMES", "2"))
    return path


@pytest.mark.slow
def test_an_hour_is_checked_run_and_reported_in_bounded_memory(hour: Path, tmp_path: Path) -> None:
    assert "2 segments, 1 criteria, about 35" in within_limit("check", hour, timeout_s=600)
    assert "PASS, 1 of 1" in within_limit("run", hour, "--out", tmp_path / "out", timeout_s=1800)
    assert "PASS, 1 of 1" in within_limit("report", tmp_path / "out", timeout_s=600)


@pytest.mark.slow
def test_a_day_is_checked_in_the_memory_of_an_hour(hour: Path) -> None:
    hour.write_text(_HOUR.replace("TIMES", "46"))
    assert "46 segments, 1 criteria, about 82" in within_limit("check", hour, timeout_s=3600)
