"""Signals in processes of their own."""

from __future__ import annotations

import subprocess
import sys

import pytest

CODE = """
import os, signal, time
from hil.app.interrupts import INTERRUPTS

class Half:
    def __del__(self):
        raise AttributeError("was never made")

INTERRUPTS.raise_from_now_on()
for answered in (False, {answered}):
    time.sleep(0.01)
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        pass
    if answered:
        INTERRUPTS.answered()
Half()
"""


@pytest.mark.parametrize("answered", [False, True])
def test_what_is_thrown_away_half_made_complains_only_where_nobody_interrupted(answered: bool) -> None:
    code = CODE.format(answered=answered)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert ("was never made" in done.stderr) == answered


TWICE = """
import os, signal, time
from hil.app import interrupts
from hil.app.interrupts import INTERRUPTS

interrupts._AT_ONCE_S = 0.5  # a machine with other work may take its time
INTERRUPTS.raise_from_now_on()
raised = 0
for apart_s in {apart_s}:
    time.sleep(apart_s)
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        raised += 1
print(raised)
"""


@pytest.mark.parametrize(("apart_s", "raised"), [((0.0, 0.0), 1), ((0.0, 0.0, 0.8), 2), ((0.0, 0.8), 2)])
def test_signals_of_one_moment_are_one(apart_s: tuple[float, ...], raised: int) -> None:
    """As `timeout` sends them: to the process, and to its group."""
    code = TWICE.format(apart_s=apart_s)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.split() == [str(raised)], done.stderr
