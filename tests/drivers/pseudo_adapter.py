"""An slcan adapter at the other end of a pseudo-terminal, that does what a test says."""

from __future__ import annotations

import contextlib
import logging
import os
import pty
import select
from collections.abc import Iterator

import pytest

from drivers import CanSettings


class PseudoAdapter:
    """`path` is what slcan opens."""

    def __init__(self) -> None:
        self._ours, self._theirs = pty.openpty()
        os.set_blocking(self._ours, False)
        self.path = os.ttyname(self._theirs)

    def say(self, *lines: str) -> None:
        """Send lines to the host, and wait until they are there."""
        self.mutter(*lines)
        select.select([self._theirs], [], [], 1.0)

    def mutter(self, *lines: str) -> None:
        """Send lines to the host, whether it reads or not."""
        os.write(self._ours, "".join(f"{line}\r" for line in lines).encode())

    def heard(self) -> list[str]:
        """Every line that the host has sent since the last call."""
        data = b""
        with contextlib.suppress(BlockingIOError):
            while piece := os.read(self._ours, 4096):
                data += piece
        return data.decode().split("\r")[:-1]

    def unplug(self) -> None:
        """Be gone."""
        for end in (self._ours, self._theirs):
            with contextlib.suppress(OSError):
                os.close(end)

    def settings(self, **changes: object) -> CanSettings:
        """What opens it."""
        options = {"sleep_after_open": 0}
        return CanSettings("rmcu", "slcan", self.path, 500_000, options=options, **changes)  # type: ignore[arg-type]


@contextlib.contextmanager
def plugged_in() -> Iterator[PseudoAdapter]:
    """An adapter for the length of a test."""
    adapter = PseudoAdapter()
    try:
        yield adapter
    finally:
        adapter.unplug()


def warnings_in(caplog: pytest.LogCaptureFixture) -> list[str]:
    """What was worth a warning; a command that ran before may have asked for more."""
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]
