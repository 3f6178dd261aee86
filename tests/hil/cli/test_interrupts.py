"""Signals in processes of their own."""

from __future__ import annotations

import subprocess
import sys

import pytest

CODE = """
import os, signal
from hil.cli._interrupts import INTERRUPTS

class Half:
    def __del__(self):
        raise AttributeError("was never made")

INTERRUPTS.raise_from_now_on()
for answered in (False, {answered}):
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
