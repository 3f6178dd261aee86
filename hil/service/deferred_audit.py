"""Rows of the audit log that no one waits for: a stop is answered before it is written down."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

from hil.service.store import DatabaseAwayError, LogStore

_AGAIN_S = 1.0  # a database that is away


class DeferredAudit:
    """Writes rows soon, or when the database answers, in their order."""

    def __init__(self, log: LogStore) -> None:
        self._log = log
        self._waiting: list[tuple[str, str, str, str, str]] = []
        self._new = asyncio.Event()

    def add(self, who: str, role: str, action: str, target: str, detail: str = "") -> None:
        """Have it written; never waits."""
        self._waiting.append((who, role, action, target, detail))
        self._new.set()

    async def work(self, closing: Callable[[], bool]) -> None:
        """Write, until the service is closed."""
        while not closing():
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._new.wait(), _AGAIN_S)
            self._new.clear()
            self.write()

    def write(self) -> None:
        """Write what waits, if the database answers."""
        with contextlib.suppress(DatabaseAwayError):
            while self._waiting:
                self._log.add(*self._waiting[0])
                del self._waiting[0]
