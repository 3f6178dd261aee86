"""The disk fills up in the middle of a run: safe, told, and all before can be read."""

from __future__ import annotations

import contextlib
import resource
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hil.core.recording import read_recording
from tests.hil.cli.test_commands import HIL

PLAN = """
name: long
steps:
  - hold_speed: {speed_km_h: 10, duration_s: 60}
"""
LARGEST_FILE = 1_500_000
SIZE_MB = 48


def assert_ended_safe(done: subprocess.CompletedProcess[str], folder: Path) -> None:
    assert done.returncode == 3, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert "the recording cannot be written" in done.stderr
    assert "disk at /" in done.stderr
    recording = read_recording(folder / "recording.mcap")
    assert recording.time_s[-1] > 2.0
    assert len(recording.damage) == 1
    assert "cut off" in recording.damage[0]
    assert "safe state confirmed" in done.stdout


@pytest.mark.slow
def test_a_file_that_may_not_grow_any_more_ends_the_run_safe(tmp_path: Path) -> None:
    (tmp_path / "long.yaml").write_text(PLAN)
    done = subprocess.run(
        [HIL, "run", tmp_path / "long.yaml", "--out", tmp_path / "out"],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE)),
    )
    assert_ended_safe(done, tmp_path / "out")


@contextlib.contextmanager
def small_disk(folder: Path) -> Iterator[Path]:
    folder.mkdir()
    mount: list[str | Path] = ["mount", "-t", "tmpfs", "-o", f"size={SIZE_MB}m", "tmpfs", folder]
    if not shutil.which("mount") or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("no disk can be mounted here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=True)


@pytest.mark.slow
def test_a_disk_that_fills_up_ends_the_run_safe_and_is_named(tmp_path: Path) -> None:
    with small_disk(tmp_path / "disk") as disk:
        (tmp_path / "long.yaml").write_text(PLAN)
        command: list[str | Path] = [HIL, "run", tmp_path / "long.yaml", "--out", disk / "out"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            recording = disk / "out" / "recording.mcap"
            while run.poll() is None and not (recording.exists() and recording.stat().st_size > 1_000_000):
                time.sleep(0.01)
            with contextlib.suppress(OSError), (disk / "other").open("wb") as other:  # somebody else's data
                while True:
                    other.write(bytes(1 << 16))
            out, err = run.communicate()
        done = subprocess.CompletedProcess(command, run.returncode, out, err)
        assert_ended_safe(done, disk / "out")
        assert f"disk at {disk}" in err
