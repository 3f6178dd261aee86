"""A line that goes away and comes back, on pseudo-terminals."""

from __future__ import annotations

import os
import pty
import select
import tty
from pathlib import Path

import pytest

from drivers.panel._panel import ReturningLine
from hil.core.errors import BenchError
from tests.clocks import SteppedClock


class Terminal:
    """A pseudo-terminal that a link names, as udev does."""

    def __init__(self, link: Path) -> None:
        self.own, self._theirs = pty.openpty()
        tty.setraw(self._theirs)
        link.unlink(missing_ok=True)
        link.symlink_to(os.ttyname(self._theirs))
        self._link = link

    def vanish(self) -> None:
        self._link.unlink()
        os.close(self.own)
        os.close(self._theirs)


def read(line: ReturningLine, count: int) -> bytes:
    data = b""
    for _ in range(500):
        data += line.drain()
        if len(data) >= count:
            break
        select.select([], [], [], 0.01)
    return data


def test_it_is_there_again_when_the_adapter_is(tmp_path: Path) -> None:
    link, clock = tmp_path / "panel", SteppedClock()
    terminal = Terminal(link)
    line = ReturningLine("panel", str(link), 9600, clock)
    os.write(terminal.own, b"one")
    assert read(line, 3) == b"one"
    assert line.send(b"two")
    terminal.vanish()
    assert line.drain() == b""
    assert line.gone
    assert not line.send(b"lost")
    clock.time_s += 1.0
    assert line.drain() == b""
    assert "No such file" in line.gone
    terminal = Terminal(link)
    assert line.drain() == b""  # it was tried a moment ago
    clock.time_s += 1.0
    line.drain()
    assert line.gone == ""
    os.write(terminal.own, b"three")
    assert read(line, 5) == b"three"
    line.close()
    terminal.vanish()


def test_one_that_is_not_there_to_begin_with_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="cannot be opened"):
        ReturningLine("panel", str(tmp_path / "none"), 9600, SteppedClock())
