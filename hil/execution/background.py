"""Work beside a service: processes that it starts, and daemon threads for what waits for a network.

Processes find the same packages, and a terminal's Ctrl-C is not for them. The end of the process does not
wait for a thread.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import resource
import sys
import threading
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from hil.core.errors import HilError

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


async def output_of(process: asyncio.subprocess.Process, within_s: float) -> tuple[bytes, bytes]:
    """What a process prints on both streams; it is killed if it is late, or if no one waits any longer.

    Raises:
        TimeoutError: it is late.
    """
    try:
        return await asyncio.wait_for(process.communicate(), within_s)
    except BaseException:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()
        raise


T = TypeVar("T")
_AGAIN_S = 0.5

logger = logging.getLogger(__name__)


async def apart(function: Callable[[], T]) -> T:
    """What the function gives or raises; neither a cancelled waiter nor the process's end waits for it."""
    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def settle(result: T | None, error: Exception | None) -> None:
        if future.done():
            return
        if error is not None:
            future.set_exception(error)
        else:
            future.set_result(result)  # type: ignore[arg-type]

    def work() -> None:
        result, failure = None, None
        try:
            result = function()
        except Exception as error:
            failure = error
        with contextlib.suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(settle, result, failure)

    threading.Thread(target=work, daemon=True).start()
    return await future


async def going_on(work: Callable[[], Coroutine[Any, Any, None]]) -> None:
    """Have work done that goes on as long as the service does.

    What the system refuses now (a descriptor, memory for a process, a disk) it gives later: such a failure
    is written down, and the work goes on. A mistake of ours ends it.
    """
    while True:
        try:
            await work()
        except (OSError, HilError) as error:
            logger.error("%s", error)
            await asyncio.sleep(_AGAIN_S)
        else:
            return
