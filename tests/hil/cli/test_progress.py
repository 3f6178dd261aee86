"""On a terminal somebody is waiting, and is reported for what."""

from __future__ import annotations

import os
import pty
import subprocess
import sys

import pytest

from hil.cli.output import time_left

_WAITS = """
import logging, time
from hil.cli.output import progress
logging.getLogger("hil").setLevel(logging.DEBUG)
with progress("plan"):
    logging.getLogger("hil.core.runtime.compiled").info("compiling %s.%s", "module", "function")
    time.sleep(0.3)
"""


def test_a_terminal_is_told_that_the_simulation_is_being_compiled() -> None:
    terminal, theirs = pty.openpty()
    asked = subprocess.Popen(
        [sys.executable, "-c", _WAITS],
        stderr=theirs,
        stdout=subprocess.DEVNULL,
        env={**os.environ, "COLUMNS": "160", "TERM": "xterm"},
    )
    os.close(theirs)
    shown = b""
    while True:
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # Linux says so when no one is at the other end any more
            break
        if not piece:
            break
        shown += piece
    os.close(terminal)
    assert asked.wait(60) == 0
    assert "compiling for this machine, once" in shown.decode()


@pytest.mark.parametrize(
    ("share", "elapsed_s", "words"),
    [
        (None, 100.0, ""),
        (0.0, 0.0, "0%"),
        (0.01, 5.0, "1%"),
        (0.25, 10.0, "25%, about 30 s left"),
        (0.1, 60.0, "10%, about 9 min left"),
        (1.0, 60.0, "100%, about 0 s left"),
    ],
)
def test_time_left_follows_from_the_share_that_is_done(
    share: float | None, elapsed_s: float, words: str
) -> None:
    assert time_left(share, elapsed_s) == words
