"""Time as an argument: a wall clock for a bench, a computed one for a simulation; and a loop that keeps up.

In a simulation waiting means computing. A loop in real time has no long pauses for garbage, and goes
ahead of others where that is allowed.
"""

from __future__ import annotations

import contextlib
import datetime
import gc
import logging
import os
import time
from collections.abc import Callable, Iterator
from typing import Protocol


def utc(since_1970_ns: int) -> str:
    """A moment as ISO 8601, to the millisecond and with its zone."""
    moment = datetime.datetime.fromtimestamp(since_1970_ns // 1_000_000 / 1e3, datetime.UTC)
    return moment.isoformat(timespec="milliseconds")


class Clock(Protocol):
    """What the engine and the drivers know of time."""

    @property
    def virtual(self) -> bool:
        """Whether waiting only means computing, so that several ticks may pass in one call."""
        ...

    def now_s(self) -> float:
        """Seconds since the bench was opened."""
        ...

    def sleep_until(self, time_s: float) -> None:
        """Return when `now_s()` has reached `time_s`; at once if it has already."""
        ...


class WallClock:
    """Monotonic real time.

    Args:
        scale: seconds of this clock in a second of real time; less than 1 for a simulated bench in a process
            of its own that cannot keep up.
    """

    virtual = False

    def __init__(self, scale: float = 1.0) -> None:
        self._start, self._scale = time.monotonic(), scale

    def now_s(self) -> float:
        """Seconds since this clock was made."""
        return (time.monotonic() - self._start) * self._scale

    def sleep_until(self, time_s: float) -> None:
        """Sleep; the last part of a millisecond is left to the operating system's timer."""
        remaining = time_s - self.now_s()
        if remaining > 0:
            time.sleep(remaining / self._scale)


_LOG = logging.getLogger(__name__)


@contextlib.contextmanager
def undisturbed(*, collections: bool) -> Iterator[bool]:
    """Keep from this thread what would hold it up for longer than a device waits for its host.

    What is there already is not looked through for garbage again. On Linux the thread comes before those of
    other programs, where the system grants it (root, CAP_SYS_NICE, or a limit `rtprio`); threads that it
    starts do not.

    Args:
        collections: whether what is added is looked through; without, only counting references frees it.

    Yields:
        whether the system granted the priority.
    """
    enabled = gc.isenabled()
    gc.collect()
    gc.freeze()
    if not collections:
        gc.disable()
    granted = _come_first()
    _LOG.info("real-time priority %s", "granted" if granted else "not granted")
    try:
        yield granted
    finally:
        if granted:
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        gc.unfreeze()
        if enabled:
            gc.enable()


@contextlib.contextmanager
def without_collections() -> Iterator[None]:
    """Look for no garbage meanwhile: for stretches in which every millisecond counts."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def as_this_thread() -> Callable[[], None]:
    """What gives the thread that calls it the priority that this one has now.

    For a thread that this one shares the interpreter with: while it holds the interpreter's lock, and other
    programs hold it up, this one waits for them too.
    """
    if not hasattr(os, "SCHED_RESET_ON_FORK"):  # Linux alone has it
        return lambda: None
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)

    def take_it() -> None:
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, policy, parameters)

    return take_it


def _come_first() -> bool:
    if not hasattr(os, "SCHED_RESET_ON_FORK"):  # Linux alone has it
        return False
    policy = os.SCHED_RR | os.SCHED_RESET_ON_FORK
    try:
        if os.sched_getscheduler(0) != os.SCHED_OTHER:  # whoever started it has chosen already
            return False
        os.sched_setscheduler(0, policy, os.sched_param(os.sched_get_priority_min(os.SCHED_RR)))
    except OSError:
        return False
    return True
