"""`hil bench monitor` in a pipe, as JSON and on a terminal, of a bench in another process."""

import json
import os
import pty
import signal
import subprocess
import time

import pytest

from tests.hil.cli.test_commands import HIL, hil
from tests.hil.cli.test_sim_bench import serving


def test_a_simulated_bench_is_told_plainly():
    assert "serve it with 'hil bench sim'" in hil("bench", "monitor", "sim", code=2).stderr


@pytest.mark.slow
def test_lines_json_and_a_terminal(tmp_path):
    with serving(tmp_path) as (_, file):
        lines = hil("bench", "monitor", file, "--for", "1", "--every", "0.4").stdout.splitlines()
        assert lines[0] == "# bus 'rmcu': nothing is sent"
        assert "motor_speed_rad_s" in lines[2]
        assert "rmcu: off" in lines[2]
        whole = json.loads(hil("bench", "monitor", file, "--for", "0.5", "--json").stdout)
        assert whole["buses"]["rmcu"]["frames_s"] > 1000
        told, code = on_a_terminal("bench", "monitor", file)
    assert code == 130
    assert b"samples/s" in told
    assert b"Traceback" not in told


def on_a_terminal(*arguments):
    """What is shown until Ctrl-C, and the exit code."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen([HIL, *map(str, arguments)], stdout=theirs, stderr=theirs, stdin=theirs)
    os.close(theirs)
    told = b""
    for _ in range(200):
        told += os.read(ours, 65536)
        if told.count(b"samples/s") > 2:
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    code = process.wait(30)
    os.close(ours)
    return told, code
