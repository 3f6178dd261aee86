"""Processes that the service begins: they find the same packages, and a terminal's Ctrl-C is not for them."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
from typing import Any


async def begun(*command: str, niceness: int = 0, **streams: Any) -> asyncio.subprocess.Process:
    """A process of its own, `niceness` added to that of the service; `streams` as asyncio takes them.

    Raises:
        OSError: it cannot be begun.
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
    if niceness:
        with contextlib.suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, process.pid, niceness)
    return process
