"""The database is asked in a thread of its own, and the service's loop goes on meanwhile.

What uses a store is plain code that calls it; it is run in turns (`in_turns`). Where a turn comes to a store,
it stands still until the thread has the answer, and the loop does other work. One thread asks, one question
after the other, each a transaction: so what a store's method does is never mixed with another's. Outside of
turns, as while a service begins, a store is asked where it is called.
"""

from __future__ import annotations

import asyncio
import functools
import inspect
from collections.abc import Callable, Coroutine, Generator
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from greenlet import getcurrent, greenlet

T = TypeVar("T")
C = TypeVar("C", bound=type)

_thread = ThreadPoolExecutor(1, "database")


class _Turn(greenlet):  # type: ignore[misc]  # it has no types
    """Code between two waits of a coroutine, which may stand still for a store."""


def asked_apart(store: C) -> C:
    """Have all public methods of a class asked in the database's thread, where a turn calls them."""
    for name, method in list(vars(store).items()):
        if inspect.isfunction(method) and not name.startswith("_"):
            setattr(store, name, _apart(method))
    return store


class _InTurns:
    def __init__(self, work: Coroutine[Any, Any, T]) -> None:
        self._work = work

    def __await__(self) -> Generator[Any, Any, Any]:
        sent, failure = None, None
        while True:
            turn = _Turn(self._step)
            turn.gr_context = getcurrent().gr_context
            found = turn.switch(sent, failure)
            while not turn.dead:  # it stands still for a store
                try:
                    answer = yield from found
                except BaseException as error:
                    found = turn.throw(error)
                else:
                    found = turn.switch(answer)
            over, value = found
            if over:
                return value
            sent, failure = None, None
            try:
                sent = yield value
            except BaseException as error:
                failure = error

    def _step(self, sent: Any, failure: BaseException | None) -> tuple[bool, Any]:
        """One turn: whether the work is over, and what it gives or waits for."""
        try:
            return False, self._work.send(sent) if failure is None else self._work.throw(failure)
        except StopIteration as ended:
            return True, ended.value


async def in_turns(work: Coroutine[Any, Any, T]) -> T:
    """What the work gives or raises; within turns it is part of these."""
    if isinstance(getcurrent(), _Turn):
        return await work
    found: T = await _InTurns(work)
    return found


def _apart(method: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(method)
    def asked(*arguments: Any, **named: Any) -> Any:
        turn = getcurrent()
        if not isinstance(turn, _Turn):
            return method(*arguments, **named)
        work = functools.partial(method, *arguments, **named)
        answer = asyncio.get_running_loop().run_in_executor(_thread, work)
        assert turn.parent is not None
        return turn.parent.switch(answer)

    return asked
