"""The operator's terminal: shown texts, and lines that were typed, without ever waiting for them."""

from __future__ import annotations

import contextlib
import os
import select
import sys

KEYS = "p + Enter: pause, q + Enter: end, e + Enter: emergency stop"
_LONGEST_LINE = 1000


class StandardTerminal:
    """Standard input and standard error.

    Lines are read only when some have come and this process is in the foreground: who reads a terminal from
    the background is stopped by the system, with torque on.
    """

    def __init__(self) -> None:
        self._descriptor = sys.stdin.fileno()
        self._begun = b""

    def tell(self, text: str) -> None:
        """Show a text."""
        print(f"\n{text}", file=sys.stderr)

    def typed(self) -> list[str]:
        """Lines that were typed since the last call; an end of file is none."""
        with contextlib.suppress(OSError):
            while self._ready() and (data := os.read(self._descriptor, _LONGEST_LINE)):
                self._begun += data
        *lines, self._begun = self._begun.split(b"\n")
        self._begun = self._begun[-_LONGEST_LINE:]
        return [line.decode("utf-8", "replace") for line in lines]

    def _ready(self) -> bool:
        if os.tcgetpgrp(self._descriptor) != os.getpgrp():
            return False
        return bool(select.select([self._descriptor], [], [], 0.0)[0])


def operators_terminal() -> StandardTerminal | None:
    """Who sits at standard input; None if no one does, or the system has no such terminals."""
    if not sys.stdin.isatty() or not hasattr(os, "tcgetpgrp"):
        return None
    return StandardTerminal()
