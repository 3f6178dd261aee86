"""Asking a run to stop: by a call, by signals, and what stays as it was afterwards."""

from __future__ import annotations

import os
import signal
import threading

import pytest

from hil.core.channels import ENDING_SIGNALS
from hil.engine.stop.stopping import StopRequest

pytestmark = pytest.mark.usefixtures("heard_hangups")


def test_whoever_works_is_told_at_once_and_each_time() -> None:
    stop, told = StopRequest(), list[str]()
    stop.ask()  # no one works: it is kept
    assert stop.times == 1
    with stop.telling(lambda: told.append("outer")):
        assert told == ["outer"]
        with stop.telling(lambda: told.append("inner")):
            stop.ask()
        assert told == ["outer", "inner", "inner"]
        stop.ask()
        assert told[3:] == ["outer"]
    stop.ask()
    assert len(told) == 4
    assert stop.times == 4


def test_nobody_is_told_before_somebody_asks() -> None:
    stop, told = StopRequest(), list[int]()
    with stop.telling(lambda: told.append(1)):
        assert told == []


@pytest.mark.parametrize("number", ENDING_SIGNALS)
def test_signals_are_requests_and_the_handlers_come_back(number: signal.Signals) -> None:
    before = {one: signal.getsignal(one) for one in ENDING_SIGNALS}
    stop = StopRequest()
    with stop.by_signals():
        os.kill(os.getpid(), number)
        with stop.by_signals():
            os.kill(os.getpid(), number)
        os.kill(os.getpid(), number)
    assert stop.times == 3
    assert {one: signal.getsignal(one) for one in ENDING_SIGNALS} == before


def test_a_hang_up_that_is_ignored_stays_ignored_and_an_ignored_interrupt_does_not() -> None:
    before = {one: signal.signal(one, signal.SIG_IGN) for one in (signal.SIGHUP, signal.SIGINT)}
    try:
        stop = StopRequest()
        with stop.by_signals():
            os.kill(os.getpid(), signal.SIGHUP)
            assert stop.times == 0
            os.kill(os.getpid(), signal.SIGINT)
            assert stop.times == 1
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)


def test_in_another_thread_signals_stay_what_they_are() -> None:
    before = signal.getsignal(signal.SIGTERM)
    inside: list[object] = []

    def work() -> None:
        with StopRequest().by_signals():
            inside.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert inside == [before]
