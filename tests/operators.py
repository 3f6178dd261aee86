"""Operators for tests: they type what they are told to, when a text is shown or after a while."""

from __future__ import annotations

import time
from collections.abc import Callable

from hil.engine.ipc.ipc_messages import EmergencyAsked, Question


class Answering:
    """Types a line, Enter alone if it is empty, after each text that is shown to it."""

    def __init__(self, answer: str = "", then: Callable[[str], None] = lambda text: None) -> None:
        self.told: list[str] = []
        self.waiting: list[str | EmergencyAsked] = []
        self._answer, self.then = answer, then

    def tell(self, text: str, question: Question | None = None) -> None:
        self.told.append(text)
        self.waiting.append(self._answer)
        self.then(text)

    def typed(self) -> list[str | EmergencyAsked]:
        waiting, self.waiting = self.waiting, []
        return waiting


class Silent(Answering):
    """Reads, and types only what a test puts into `waiting`."""

    def tell(self, text: str, question: Question | None = None) -> None:
        self.told.append(text)
        self.then(text)


class Slow(Silent):
    """Presses Enter a while after a text was shown."""

    def __init__(self, after_s: float) -> None:
        super().__init__()
        self._after_s, self._due_s = after_s, float("inf")

    def tell(self, text: str, question: Question | None = None) -> None:
        super().tell(text, question)
        self._due_s = time.monotonic() + self._after_s

    def typed(self) -> list[str | EmergencyAsked]:
        if time.monotonic() < self._due_s:
            return []
        self._due_s = float("inf")
        return [""]
