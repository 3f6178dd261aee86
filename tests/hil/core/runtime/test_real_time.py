"""What a loop in real time is spared, and that all is as before afterwards."""

from __future__ import annotations

import gc
import os
import threading

import pytest

from hil.core.runtime.clock import as_this_thread, undisturbed


@pytest.mark.parametrize("collections", [True, False])
def test_all_is_as_before_afterwards(collections):
    frozen = gc.get_freeze_count()
    with undisturbed(collections=collections):
        assert gc.isenabled() is collections
        assert gc.get_freeze_count() > frozen
    assert gc.isenabled()
    assert gc.get_freeze_count() <= frozen


@pytest.mark.skipif(not hasattr(os, "SCHED_RESET_ON_FORK"), reason="Linux alone has it")
def test_only_the_thread_itself_comes_first_and_only_for_the_time():
    def policy():
        return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK

    before, of_others = policy(), []
    with undisturbed(collections=True) as granted:
        assert policy() == (os.SCHED_RR if granted else before)
        thread = threading.Thread(target=lambda: of_others.append(policy()))
        thread.start()
        thread.join()
    assert policy() == before
    assert of_others == [before]


@pytest.mark.skipif(not hasattr(os, "SCHED_RESET_ON_FORK"), reason="Linux alone has it")
def test_a_thread_that_is_waited_for_has_the_priority_of_who_waits():
    found = []

    def look(as_who_waits):
        as_who_waits()
        found.append(os.sched_getscheduler(0))

    with undisturbed(collections=True):
        wanted = os.sched_getscheduler(0)
        thread = threading.Thread(target=look, args=(as_this_thread(),))
        thread.start()
        thread.join()
    assert found == [wanted]
