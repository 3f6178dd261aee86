"""One function of many things at once, on as many threads as numba may use.

For compiled functions and numpy, which let other threads run meanwhile. The calling thread works too, and
does alone what no other thread has started: so one call may stand within another, whoever runs it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import Lock
from typing import Generic, TypeVar

_Thing = TypeVar("_Thing")
_Result = TypeVar("_Result")


def threads() -> int:
    """How many threads may compute at once: NUMBA_NUM_THREADS, or as many as there are processors."""
    from numba.core import config  # only to compute: slow to import

    return int(config.NUMBA_NUM_THREADS)


def map_on_threads(function: Callable[[_Thing], _Result], things: Sequence[_Thing]) -> list[_Result]:
    """`function` of each of `things`, in their order.

    Raises:
        Exception: the first thing's whose function raises, once what has been started is over.
    """
    if threads() < 2 or len(things) < 2:
        return [function(thing) for thing in things]
    return _Work(function, things).done()


@cache
def _pool(process: int) -> ThreadPoolExecutor:  # a forked process has none of its parent's threads
    del process
    return ThreadPoolExecutor(threads() - 1, thread_name_prefix="side-by-side")


class _Work(Generic[_Thing, _Result]):
    """Things that wait, and results of those that are done."""

    def __init__(self, function: Callable[[_Thing], _Result], things: Sequence[_Thing]) -> None:
        self._function, self._things = function, things
        self._waiting = iter(range(len(things)))
        self._taking = Lock()
        self._results: dict[int, _Result] = {}
        self._errors: dict[int, BaseException] = {}

    def done(self) -> list[_Result]:
        """All results."""
        pool = _pool(os.getpid())
        others = [pool.submit(self._go_on) for _ in range(min(threads(), len(self._things)) - 1)]
        try:
            self._go_on()
        finally:
            self._waiting = iter(())
            for other in others:
                if not other.cancel():
                    other.result()
        if self._errors:
            raise self._errors[min(self._errors)]
        return [self._results[index] for index in range(len(self._things))]

    def _go_on(self) -> None:
        """Take one thing after the other until none waits."""
        while True:
            with self._taking:
                index = next(self._waiting, None)
            if index is None:
                return
            try:
                self._results[index] = self._function(self._things[index])
            except Exception as error:  # raised where it was asked for
                self._errors[index] = error
                self._waiting = iter(())
