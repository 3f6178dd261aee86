"""Processes that the service begins: they find the same packages, and a terminal's Ctrl-C is not for them."""

from __future__ import annotations

import asyncio
import contextlib
import os
import resource
import sys
from typing import Any

#: Memory of a process that reads or predicts what somebody gave, beside benches that run: a segment of an
#: hour takes 1.8 GB, a day of shorter ones 0.3. One that identifies, diagnoses or simulates: half of all.
FORECAST_BYTES = 3_000_000_000
STUDY_BYTES = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2


async def start_process(
    *command: str, niceness: int = 0, most_bytes: int = 0, **streams: Any
) -> asyncio.subprocess.Process:
    """A process of its own.

    Args:
        niceness: added to that of the service.
        most_bytes: of memory that it, and each process that it begins, may take; 0 for no limit.
        streams: as asyncio takes them.

    Raises:
        OSError: it cannot be started.
    """
    process = await asyncio.create_subprocess_exec(
        *command,
        env={
            "OPENBLAS_NUM_THREADS": "1",
            **os.environ,
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        },
        start_new_session=True,
        **streams,
    )
    if most_bytes:
        with contextlib.suppress(OSError):  # it has ended
            resource.prlimit(process.pid, resource.RLIMIT_DATA, (most_bytes, most_bytes))
    if niceness:
        with contextlib.suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, process.pid, niceness)
    return process
