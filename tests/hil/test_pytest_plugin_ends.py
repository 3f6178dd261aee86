"""A test that is timed out or cancelled ends its run first; a plan is run once, whatever other plugins do."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow
LONG = "name: long\nsteps:\n  - hold_speed: {speed_km_h: 5, duration_s: 3000}\n"
SHORT = """
name: short
steps:
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 10, before_s: 0.2, after_s: 0.5}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 1, unit: N m}
"""
#: Fails if a run that was started in the same folder is still there.
FIRST_AND_SECOND = """
import subprocess
def test_first(bench):
    bench.run("long.yaml")
def test_second(bench):
    lines = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True).stdout.splitlines()
    assert not [line for line in lines if "test_first" in line and str(bench._beside) in line]
    bench.run("short.yaml")
"""


def session(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-rA", "-p", "no:cacheprovider", "--bench", "sim", *arguments]
    return subprocess.run(
        [*command, "--bench-out", str(folder / "out")],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
    )


def alive(folder: Path) -> list[str]:
    """Processes that name the folder."""
    lines = subprocess.run(
        ["ps", "-eo", "args"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return [line for line in lines if str(folder / "out") in line]


def started(folder: Path) -> list[str]:
    """Runs that have a recording."""
    return sorted(str(path.parent.relative_to(folder / "out")) for path in folder.rglob("recording.mcap"))


def test_a_timeout_by_signal_ends_the_run_and_the_plan_is_not_started_again(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(LONG)
    done = session(tmp_path, "--timeout", "8", "--timeout-method", "signal")
    assert alive(tmp_path) == []
    assert done.returncode == 1, done.stdout + done.stderr
    assert "1 failed, 1 skipped" in done.stdout
    assert "Timeout" in done.stdout
    assert "the run was cut off" in done.stdout
    assert started(tmp_path) == ["plan_yaml-001"]
    assert (
        json.loads((tmp_path / "out/plan_yaml-001/result.json").read_text())["safe_state"] != "not_confirmed"
    )


def test_the_next_test_begins_when_the_run_of_the_last_has_ended(tmp_path: Path) -> None:
    (tmp_path / "long.yaml").write_text(LONG)
    (tmp_path / "short.yaml").write_text(SHORT)
    (tmp_path / "test_own.py").write_text(FIRST_AND_SECOND)
    done = session(tmp_path, "--timeout", "12", "--timeout-method", "signal")
    assert "1 failed, 1 passed" in done.stdout, done.stdout + done.stderr
    assert started(tmp_path) == ["test_own_py__test_first/long-001", "test_own_py__test_second/short-001"]


def test_a_timeout_by_thread_ends_pytest_and_the_run_ends_by_itself(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(LONG)
    done = session(tmp_path, "--timeout", "8", "--timeout-method", "thread")
    assert done.returncode != 0
    assert "Timeout" in done.stderr + done.stdout
    for _ in range(300):
        if not alive(tmp_path):
            break
        time.sleep(0.1)
    assert alive(tmp_path) == []
    assert len(started(tmp_path)) == 1


def test_ctrl_c_waits_until_the_bench_is_safe(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(LONG)
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-p",
        "no:cacheprovider",
        "--bench",
        "sim",
        "--bench-out",
        "out",
    ]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    while not list(tmp_path.rglob("recording.mcap")) and process.poll() is None:
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGINT)
    reported, _ = process.communicate(timeout=120)
    assert process.returncode == 2, reported
    assert list(tmp_path.rglob("result.json")), reported


def test_reruns_repeat_the_judgement_and_not_the_run(tmp_path: Path) -> None:
    pytest.importorskip("pytest_rerunfailures")
    (tmp_path / "plan.yaml").write_text(SHORT)
    done = session(tmp_path, "--reruns", "2")
    assert "1 failed, 2 passed, 2 rerun" in done.stdout, done.stdout + done.stderr
    assert started(tmp_path) == ["plan_yaml-001"]


@pytest.mark.parametrize("mode", ["load", "each", "loadscope", "worksteal"])
def test_workers_of_xdist_share_the_run_of_a_plan(mode: str, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(SHORT)
    done = session(tmp_path, "-n", "2", "--dist", mode)
    counts = "2 failed, 4 passed" if mode == "each" else "1 failed, 2 passed"
    assert counts in done.stdout, done.stdout + done.stderr
    assert started(tmp_path) == ["plan_yaml-001"]


def test_a_worker_that_is_killed_does_not_begin_its_plan_again(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(LONG)
    done = session(tmp_path, "-n", "1", "--timeout", "12", "--timeout-method", "thread")
    assert "crashed" in done.stdout, done.stdout + done.stderr
    assert "cut off when its worker ended" in done.stdout
    assert started(tmp_path) == ["plan_yaml-001"]
    assert alive(tmp_path) == []
