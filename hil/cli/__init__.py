"""How people ask: the `hil` command. Commands, outputs and exit codes: docs/reference/commands.md.

This module imports next to nothing, so that Ctrl-C during the slow imports is already answered.
"""

from __future__ import annotations

import gc
import os
import sys

from hil.app.interrupts import EXIT_CODE, INTERRUPTS

# What imports leave is no garbage: looked through every 700 objects, as by default, it took a tenth of a run.
_LOOKED_THROUGH_EVERY = (50_000, 20, 20)


def main() -> None:
    """Run the command line of this process and exit with its code."""
    try:
        INTERRUPTS.raise_from_now_on()
        gc.set_threshold(*_LOOKED_THROUGH_EVERY)
        # The matrices here are small: more threads of OpenBLAS would only wait for each other, and cost time.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        os.environ.setdefault(
            "PYTHONWARNINGS", "ignore"
        )  # of processes started by this one; here the log has them
        from hil.cli._app import run_command_line

        code = run_command_line()
        INTERRUPTS.ignore_from_now_on()
        gc.freeze()  # the process ends: its last look for garbage took 0.7 s
    except BaseException:
        if not INTERRUPTS.arrived:
            raise
        INTERRUPTS.ignore_from_now_on()
        INTERRUPTS.tell()
        code = EXIT_CODE
    sys.exit(code)


__all__ = ["main"]
