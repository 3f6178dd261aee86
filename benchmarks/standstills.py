"""When the machine itself stood still: a loop that only sleeps, on the processor of what is measured.

It comes before everything else there, so nothing but the machine holds it up: whoever lends the processor to
others (a hypervisor), interrupts, the kernel. Needs the right to a real-time priority (root, CAP_SYS_NICE, or
a limit `rtprio`).
"""

from __future__ import annotations

import contextlib
import fcntl
import gc
import os
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Times: TypeAlias = npt.NDArray[np.float64]

_PERIOD_S = 0.5e-3
_NOTICED_S = 0.15e-3  # a sleep is late by a tenth of this on a machine that does not stand still
_PRIORITY = 2  # a run has 1
_PIPE_BYTES = 1 << 20  # no one reads until the end: some 65,000 standstills


@dataclass
class Standstills:
    """Begin and end of each, s since 1970, shape (n, 2); there when looking has ended."""

    found: Times = field(default_factory=lambda: np.zeros((0, 2)))

    def within(self, begin_s: Times, end_s: Times) -> Times:
        """For how much of each stretch of time, s since 1970, the processor stood still, s."""
        return self._until(end_s) - self._until(begin_s)

    def _until(self, time_s: Times) -> Times:
        """For how long it had stood still by then, s; `time_s` shape (n,)."""
        begin_s, end_s = self.found.T
        before = np.concatenate([[0.0], np.cumsum(end_s - begin_s)])
        started = np.searchsorted(begin_s, time_s)
        not_over = np.where(started > 0, np.maximum(0.0, np.append(end_s, 0.0)[started - 1] - time_s), 0.0)
        return np.asarray(before[started] - not_over)


@contextlib.contextmanager
def looking(processor: int) -> Iterator[Standstills]:
    """Look for standstills of a processor, in a process of its own, until this is left."""
    standstills = Standstills()
    command = [sys.executable, "-m", "benchmarks.standstills", str(processor)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    fcntl.fcntl(process.stdout, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)
    try:
        yield standstills
    finally:
        early = process.poll() is not None
        process.kill()
        data, _ = process.communicate()
        standstills.found = np.frombuffer(data).reshape(-1, 2)
    if early:
        raise SystemExit("no one has looked whether the machine stood still: no real-time priority?")


def look(processor: int) -> None:
    """Tell begin and end of every standstill on standard output, until this process is ended."""
    os.sched_setaffinity(0, {processor})
    os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))
    gc.disable()
    meant_s = time.time()
    while True:
        last_s, meant_s = meant_s, meant_s + _PERIOD_S
        time.sleep(max(0.0, meant_s - time.time()))
        now_s = time.time()
        if now_s - meant_s > _NOTICED_S:
            os.write(1, struct.pack("dd", last_s, now_s))
            meant_s = now_s


if __name__ == "__main__":
    look(int(sys.argv[1]))
