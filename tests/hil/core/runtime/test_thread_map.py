"""Things done side by side: in their order, one call within another, errors told, nothing left running."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.runtime import thread_map as module
from hil.core.runtime.thread_map import map_on_threads


@pytest.fixture(autouse=True)
def _on_four_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "threads", lambda: 4)
    module._pool.cache_clear()


@given(st.lists(st.integers(), max_size=40))
def test_results_stand_in_the_order_of_the_things(things: list[int]) -> None:
    assert map_on_threads(lambda x: x * x, things) == [x * x for x in things]


def test_several_threads_work_at_once() -> None:
    together = threading.Barrier(4, timeout=20.0)
    map_on_threads(lambda _: together.wait(), range(4))  # breaks where fewer than four are there


def test_calls_within_calls_come_to_an_end() -> None:
    """More callers than threads, each of which waits for what it asked for."""

    def deep(level: int) -> int:
        return 1 if level == 0 else sum(map_on_threads(deep, [level - 1] * 5))

    assert deep(4) == 5**4


def failing_at(*numbers: int) -> Callable[[int], int]:
    def function(number: int) -> int:
        if number in numbers:
            raise ValueError(str(number))
        return number

    return function


def test_an_error_is_told_and_what_waits_is_not_begun() -> None:
    started: list[int] = []

    def function(number: int) -> None:
        started.append(number)
        if number == 0:
            raise ValueError("first")
        time.sleep(0.001)

    with pytest.raises(ValueError, match="first"):
        map_on_threads(function, range(1000))
    known = len(started)
    assert known < 1000
    time.sleep(0.05)
    assert len(started) == known  # nothing goes on behind the caller's back


def test_of_several_errors_the_first_thing_s_is_told() -> None:
    with pytest.raises(ValueError, match="^0$"):
        map_on_threads(failing_at(0, 1, 2, 3), range(4))


def test_ctrl_c_in_the_calling_thread_ends_it() -> None:
    caller = threading.current_thread()

    def function(number: int) -> None:
        if threading.current_thread() is caller:
            raise KeyboardInterrupt
        time.sleep(0.001)

    with pytest.raises(KeyboardInterrupt):
        map_on_threads(function, range(1000))


FORKED = """import os
from hil.core.runtime.thread_map import map_on_threads, threads
assert threads() == 3
assert map_on_threads(abs, range(-100, 0)) == list(range(100, 0, -1))
child = os.fork()
if child == 0:
    os._exit(0 if map_on_threads(abs, range(-100, 0)) == list(range(100, 0, -1)) else 1)
assert os.waitpid(child, 0)[1] == 0
"""


def test_a_forked_process_has_threads_of_its_own() -> None:
    """A pool's threads do not come along with a fork: who asked would wait for ever."""
    environment = {**os.environ, "NUMBA_NUM_THREADS": "3"}
    subprocess.run([sys.executable, "-c", FORKED], env=environment, check=True, timeout=60)
