"""Ctrl-C while what is known is still wanted: once it is told, twice it ends."""

from __future__ import annotations

from collections.abc import Callable

from hil.cli._interrupts import INTERRUPTS
from hil.engine import StopRequest


def at_once(stop: StopRequest) -> Callable[[], None]:
    """Asked once, what is under way is still finished and written, which takes a while; not asked again."""

    def told() -> None:
        if stop.times > 1:
            INTERRUPTS.arrived = True
            raise KeyboardInterrupt

    return told
