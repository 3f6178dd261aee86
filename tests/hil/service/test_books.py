"""The database is asked apart: the loop goes on meanwhile, and each question is a whole."""

from __future__ import annotations

import asyncio
import contextvars
import sqlite3
import threading
import time
from pathlib import Path

import pytest

from hil.service.store import asked_apart, in_turns
from tests.hil.service.served import RefusedError, Served, served

_number = contextvars.ContextVar("number", default=0)


@asked_apart
class Store:
    """Answers when it is let."""

    def __init__(self) -> None:
        self.let, self.asked = threading.Event(), threading.Event()
        self.threads: list[int] = []

    def answer(self, number: int) -> int:
        self.threads.append(threading.get_ident())
        self.asked.set()
        assert self.let.wait(30)
        if number < 0:
            raise ValueError(number)
        return self._doubled(number)

    def several(self, *numbers: int) -> list[int]:
        return [self.answer(number) for number in numbers]

    def _doubled(self, number: int) -> int:
        self.threads.append(threading.get_ident())
        return 2 * number


def plain(store: Store, number: int) -> int:
    """Code that knows nothing of turns."""
    return store.answer(number)


def test_the_loop_goes_on_while_a_store_is_asked() -> None:
    store = Store()

    async def work(number: int) -> tuple[int, int]:
        _number.set(number)
        found = plain(store, number)
        await asyncio.sleep(0)
        return found, _number.get()

    async def all_of_it() -> list[tuple[int, int]]:
        several = [asyncio.create_task(in_turns(work(number))) for number in (1, 2)]
        while not store.asked.is_set():
            await asyncio.sleep(0.001)  # a loop that is held up never comes here
        store.let.set()
        return [await one for one in several]

    assert asyncio.run(all_of_it()) == [(2, 1), (4, 2)]
    assert threading.get_ident() not in store.threads


def test_what_a_store_raises_comes_where_it_was_asked_and_it_asks_itself_at_once() -> None:
    store = Store()
    store.let.set()

    async def work() -> list[int]:
        with pytest.raises(ValueError, match="-1"):
            plain(store, -1)
        return await in_turns(inner())

    async def inner() -> list[int]:
        return store.several(1, 2, 3)

    assert asyncio.run(in_turns(work())) == [2, 4, 6]


def test_who_is_cancelled_hears_it_where_they_wait() -> None:
    store, seen = Store(), []

    async def work() -> None:
        try:
            plain(store, 1)
        except asyncio.CancelledError:
            seen.append("cancelled")
            raise

    async def all_of_it() -> None:
        task = asyncio.create_task(in_turns(work()))
        while not store.asked.is_set():
            await asyncio.sleep(0.001)
        task.cancel()
        store.let.set()
        with pytest.raises(asyncio.CancelledError):
            await task

    asyncio.run(all_of_it())
    assert seen == ["cancelled"]


def test_outside_of_turns_a_store_is_asked_where_it_is_called() -> None:
    store = Store()
    store.let.set()
    assert store.several(1, 2) == [2, 4]
    assert set(store.threads) == {threading.get_ident()}


@pytest.mark.slow
def test_who_needs_no_database_is_answered_while_one_that_is_locked_is_waited_for(tmp_path: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        path = tmp_path / "data/service.sqlite"
        if not path.is_file():
            pytest.skip("only SQLite is locked by whoever writes to it")
        service.get("/plans")
        connection = sqlite3.connect(path, isolation_level=None)
        connection.execute("BEGIN EXCLUSIVE")
        try:
            waiting = threading.Thread(target=_queue, args=(service,))
            waiting.start()
            time.sleep(0.3)
            service.ask("GET", "/")
            assert waiting.is_alive()  # it waits for the lock, and no one waits with it
            waiting.join()
        finally:
            connection.execute("ROLLBACK")
            connection.close()


def _queue(service: Served) -> None:
    with pytest.raises(RefusedError, match="503"):
        service.queue("acceptance")
