"""Runs what may wait for a network in a daemon thread: the end of the process does not wait for it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import threading
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from hil.core.errors import HilError

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
