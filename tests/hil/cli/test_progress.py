"""On a terminal somebody is waiting, and is told for what."""

from __future__ import annotations

import os
import pty
import subprocess
import sys

_WAITS = """
import logging, time
from hil.cli._output import progress
logging.getLogger("hil").setLevel(logging.DEBUG)
with progress("plan"):
    logging.getLogger("hil.core.compiled").info("compiling %s.%s", "module", "function")
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
        except OSError:  # Linux says so when nobody is at the other end any more
            break
        if not piece:
            break
        shown += piece
    os.close(terminal)
    assert asked.wait(60) == 0
    assert "compiling for this machine, once" in shown.decode()
