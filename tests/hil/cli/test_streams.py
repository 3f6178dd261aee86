"""Closed, full, cut off and ASCII streams: they change neither what a command does nor how it ends."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from hil.cli.streams import TolerantOutput

HIL = Path(sys.executable).parent / "hil"


def shell(line: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    line = line.replace("HIL", str(HIL))
    return subprocess.run(
        ["bash", "-c", line], capture_output=True, timeout=120, env={**os.environ, **environment}, check=False
    )


@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ("HIL schema plan >&-", 0, b""),
        ("HIL schema plan 2>&-", 0, b""),
        ("HIL schema plan <&-", 0, b""),
        ("HIL schema plan > /dev/full", 3, b"standard output: No space left on device"),
        ("HIL schema cat 2> /dev/full", 2, b""),
        ("HIL schema cat > /dev/full", 2, b"there is no schema"),
        ("HIL schema cat >&- 2>&-", 2, b""),
        ("HIL schema plan | head -c 1 > /dev/null; exit ${PIPESTATUS[0]}", 0, b""),
        ("HIL --help | true; exit ${PIPESTATUS[0]}", 0, b""),
    ],
)
def test_streams_that_fail(line: str, code: int, said: bytes) -> None:
    done = shell(line)
    assert (done.returncode, b"Traceback" in done.stderr) == (code, False), done.stderr
    assert said in done.stderr
    if not said and b"head" not in line.encode():
        assert done.stderr == b""


def test_ascii_output_is_readable_and_json_stays_json() -> None:
    done = shell("HIL schema plan", PYTHONIOENCODING="ascii")
    assert done.returncode == 0
    assert json.loads(done.stdout) == json.loads(shell("HIL schema plan", PYTHONIOENCODING="utf-8").stdout)
    program = "from hil.cli.streams import tolerate_outputs as t; t(); print('≤ 5 (rad/s)² ‹試›')"
    text = shell(f'{sys.executable} -c "{program}"', PYTHONIOENCODING="ascii")
    assert text.stdout == b"<= 5 (rad/s)^2 <\\u8a66>\n", text.stderr


def test_a_file_opened_with_a_closed_stdout_does_not_become_it(tmp_path: Path) -> None:
    program = (
        "from hil.cli.streams import tolerate_outputs; tolerate_outputs(); "
        f"f = open({str(tmp_path / 'f')!r}, 'w'); print('to no one'); f.write('content')"
    )
    assert shell(f'{sys.executable} -c "{program}" >&-').returncode == 0
    assert (tmp_path / "f").read_text() == "content"


def test_a_reader_that_went_is_no_failure_and_a_full_disk_is() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    gone = TolerantOutput(writing)
    assert gone.write(b"lost") == 4
    assert gone.failure is None
    os.close(writing)
    full = os.open("/dev/full", os.O_WRONLY)
    stuck = TolerantOutput(full)
    assert stuck.write(b"lost") == 4
    assert stuck.failure is not None
    os.close(full)
