"""Calls in a process of their own: what they give, what they raise, and how they are ended."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.runtime.other_process import OtherProcess


def doubled(values: np.ndarray) -> tuple[np.ndarray, int]:
    print("what a library says is no answer")
    return 2.0 * values, os.getpid()


def refuse(name: str) -> None:
    raise BadInputError(f"no {name}", where="here", fix="give one")


def break_down() -> None:
    raise ZeroDivisionError("in a fit")


def die() -> None:
    os.write(2, b"out of luck")
    os._exit(7)


def test_it_gives_what_the_call_gave_from_another_process() -> None:
    values, number = OtherProcess(doubled, np.arange(1e6)).result()
    assert values[-1] == 2 * (1e6 - 1)
    assert number != os.getpid()


def test_what_the_call_raises_is_raised() -> None:
    with pytest.raises(BadInputError, match="no segment") as caught:
        OtherProcess(refuse, "segment").result()
    assert (caught.value.where, caught.value.fix) == ("here", "give one")
    with pytest.raises(BenchError, match="ZeroDivisionError: in a fit"):
        OtherProcess(break_down).result()


def test_a_process_that_dies_is_told_with_its_last_words() -> None:
    with pytest.raises(BenchError, match="ended with code 7: .*out of luck"):
        OtherProcess(die).result()


def test_it_can_be_killed_at_any_time() -> None:
    sleeping = OtherProcess(time.sleep, 3600.0)
    assert not sleeping.done()
    sleeping.kill()
    with pytest.raises(BenchError, match="ended with code -9"):
        sleeping.result()
    assert sleeping.done()


def test_what_cannot_be_handed_over_is_told() -> None:
    with pytest.raises(BenchError, match="internal error"):
        OtherProcess(lambda: 1).result()


def test_it_ends_with_the_process_that_asked_for_it() -> None:
    text = (
        "import time\nfrom hil.core.runtime.other_process import OtherProcess\n"
        "asked = OtherProcess(time.sleep, 600)\nprint(asked._process.pid, flush=True)\ntime.sleep(600)\n"
    )
    with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True) as asking:
        assert asking.stdout is not None
        number = int(asking.stdout.readline())
        time.sleep(1.0)  # it has started
        assert Path(f"/proc/{number}").exists()
        asking.kill()
    for _ in range(200):
        if not Path(f"/proc/{number}").exists():
            return
        time.sleep(0.05)
    raise AssertionError("it goes on")
