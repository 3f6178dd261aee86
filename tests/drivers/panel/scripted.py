"""A line on which every byte is foretold: what is sent otherwise, or not at all, fails the test."""

from __future__ import annotations

from typing import Any

from drivers import BusLoop
from tests.clocks import SteppedClock


class ScriptedLine:
    """`exchanges`: what is to be sent, and the pieces that come in answer, one at each look."""

    gone = ""

    def __init__(self, *exchanges: tuple[bytes, *tuple[bytes, ...]]) -> None:
        self.left = list(exchanges)
        self._coming: list[bytes] = []

    def send(self, data: bytes) -> bool:
        assert self.left, f"nothing more was to be sent, but {data!r}"
        wanted, *answers = self.left.pop(0)
        assert data == wanted
        self._coming += answers
        return True

    def drain(self) -> bytes:
        return self._coming.pop(0) if self._coming else b""

    def close(self) -> None:
        assert not self.left, f"was never sent: {self.left!r}"
        assert not self._coming, f"was never taken: {self._coming!r}"


def loop() -> BusLoop:
    return BusLoop(SteppedClock(), [])


def as_line(line: ScriptedLine) -> Any:
    return line
