"""`python -m hil.app.worker.hold`: the process that holds the hardware. `hil run` starts it, no one else."""

from __future__ import annotations

import contextlib
import os
import sys

HOLDER = (sys.executable, "-m", "hil.app.worker.hold")


def main() -> None:
    """Execute the run that is asked for on standard input."""
    reading, writing = os.dup(0), os.dup(1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what a library prints is no message
    from hil.app.worker.lean_imports import import_python_can

    import_python_can()
    from hil.engine.ipc.ipc_pipe import IpcPipe
    from hil.engine.process.hardware_process import hold_hardware

    unheard = hold_hardware(IpcPipe(reading, writing))
    with contextlib.suppress(OSError):  # no one may be left to read this either
        if unheard:
            os.write(2, f"error: the command has ended before its run\n  {unheard}\n".encode())


if __name__ == "__main__":
    main()
