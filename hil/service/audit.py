"""The audit log: whether it is as it was written, and rows that no one waits for.

It is read when a service begins and ends, and to verify. A stop is answered before it is written down.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Callable
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import read_text, write_atomically
from hil.service.store import AuditCheck, AuditHead, DatabaseAwayError, LogStore, open_database

#: Where the log ended when the service last looked: rows that are missing at its end are seen by it.
HEAD = "audit.head"
DATABASE = "service.sqlite"

logger = logging.getLogger(__name__)


def problem_of(log: LogStore, folder: Path) -> str:
    """What is wrong with the log; '' if nothing is. Where it ends is kept in the service's folder."""
    found = log.check(_head(folder))
    if found.problem:
        logger.error("the audit log was changed: %s", found.problem)
    elif found.head.id:
        content = {"id": found.head.id, "chain": found.head.chain}
        write_atomically(folder / HEAD, json.dumps(content) + "\n")
    return found.problem


def checked(folder: Path, database: str = "") -> AuditCheck:
    """The log of a service by its folder; it may run meanwhile.

    Raises:
        BadInputError: the folder is none of a service.
        BenchError: its database cannot be used.
    """
    if not is_service_folder(folder):
        raise BadInputError(
            "is not the directory of a service",
            where=str(folder),
            fix="give the --data directory of the service",
        )
    engine = open_database(database or f"sqlite:///{folder.resolve() / DATABASE}")
    try:
        return LogStore(engine).check(_head(folder))
    finally:
        engine.dispose()


def is_service_folder(folder: Path) -> bool:
    """Whether a service keeps its data there."""
    return (folder / "service.id").is_file() or (folder / DATABASE).is_file()


def _head(folder: Path) -> AuditHead | None:
    path = folder / HEAD
    if not path.is_file():
        return None
    try:
        found = json.loads(read_text(path))
        return AuditHead(int(found["id"]), str(found["chain"]))
    except (ValueError, KeyError, TypeError):
        return None


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
