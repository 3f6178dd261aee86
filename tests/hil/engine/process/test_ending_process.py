import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from hil.engine.process.hardware_process import is_ending

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="Linux only")


def test_one_that_runs_is_not_ending_nor_one_that_stands_still():
    assert not is_ending(os.getpid())
    with subprocess.Popen(["sleep", "60"]) as process:
        process.send_signal(signal.SIGSTOP)
        assert not is_ending(process.pid)
        process.kill()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_one_that_has_ended_is_known_before_anybody_asks_how(number):
    with subprocess.Popen(["sleep", "60"]) as process:
        process.send_signal(number)
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        assert is_ending(process.pid)


def test_its_name_may_look_like_the_fields_that_follow(tmp_path):
    named = tmp_path / "a) Z 1 (b"
    shutil.copy(str(shutil.which("sleep")), named)
    with subprocess.Popen([named, "60"]) as process:
        assert not is_ending(process.pid)
        process.kill()


def test_of_a_process_that_nobody_knows_the_pipes_have_told():
    with subprocess.Popen(["true"]) as process:
        pass
    assert not is_ending(process.pid)
