"""Brings files of runs that are over to the archive, and back when they are asked for.

What is done again and again is done less often while a network does not answer.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from functools import partial
from pathlib import Path

from hil.core.errors import HilError
from hil.core.files import sha256_of
from hil.execution.background import apart
from hil.execution.data_folder import LOCK, files_in, folder_of
from hil.service.archive._archive import PIECE_BYTES, Archive, ArchiveAwayError, Kept
from hil.service.store import DatabaseAwayError, FileStore, KeptFile

_LOOK_S = 2.0
_LONGEST_S = 60.0  # between two tries while the store is away

logger = logging.getLogger(__name__)


class Rounds:
    """Goes round until it is cancelled; `problem` is what kept the last round from its work, '' if nothing.

    Args:
        once: goes round; what keeps a part of the work from being done, '' if nothing does.
        what: whose, as the log has it.
    """

    def __init__(self, once: Callable[[], Awaitable[str]], what: str) -> None:
        self._once, self._what = once, what
        self.problem = ""
        self.count = 0

    async def work(self) -> None:
        """Go round."""
        wait_s = _LOOK_S
        while True:
            try:
                text = await self._once()
            except (ArchiveAwayError, DatabaseAwayError) as error:
                text = str(error)
            wait_s = min(2.0 * wait_s, _LONGEST_S) if text else _LOOK_S
            if text and text != self.problem:
                logger.warning("%s wait: %s", self._what, text)
            elif self.problem and not text:
                logger.warning("%s are kept again", self._what)
            self.problem = text
            self.count += 1
            await asyncio.sleep(wait_s)


_DAY_S = 86400.0
_CLEAR_S = 3600.0  # how often old files are looked for; after each run that was kept, too
_LEAST_S = 600.0  # what was brought back is being read


class Keeper:
    """Keeps runs' files in an archive; what a run writes never waits for it.

    A file stays here until the archive has given it back as it was. Whatever the moment at which the service
    is killed: what is not written down as kept is brought there again.

    Args:
        service: whose runs, by the name it has in the database.
        folder: where runs have their folders.
        shown: runs whose files are being looked at here.
        local_days: how long files stay here that the archive has.
    """

    def __init__(
        self,
        archive: Archive,
        files: FileStore,
        service: str,
        folder: Path,
        shown: Callable[[], set[int]],
        local_days: float,
    ) -> None:
        self._archive, self._files, self._service = archive, files, service
        self._folder, self._shown = folder, shown
        self._local_s = max(local_days * _DAY_S, _LEAST_S)
        self.rounds = Rounds(self._round, "files of runs")
        self._cleared_s = -1e9

    def waiting(self) -> int:
        """How many runs' files the archive has not all."""
        return self._files.waiting(self._service)

    async def work(self) -> None:
        """Keep what is to be kept, until it is cancelled."""
        await self.rounds.work()

    async def bring_back(self, run: int, name: str) -> Path:
        """A file of a run, here.

        Raises:
            ArchiveAwayError: the archive does not give it, or not as it was.
        """
        path = folder_of(self._folder, run) / name
        found = None if path.is_file() else self.kept(run, name)
        if found is not None:
            wanted = Kept(found.size, found.sha256)
            await apart(partial(self._archive.get, _name(run, name), path, wanted))
        return path

    def kept(self, run: int, name: str) -> KeptFile | None:
        """A file of a run as the archive has it; None if it has none."""
        return next((file for file in self._files.of(run) if file.name == name), None)

    def names(self, run: int) -> list[str]:
        """Names of files of a run that the archive has, as far as is known now."""
        with contextlib.suppress(DatabaseAwayError):
            return [file.name for file in self._files.of(run)]
        return []

    async def pieces(self, run: int, name: str, start: int, end: int) -> AsyncIterator[bytes]:
        """A file from `start` to before `end`, a piece at a time.

        Raises:
            ArchiveAwayError: the archive does not give it.
        """
        for at in range(start, end, PIECE_BYTES):
            until = min(end, at + PIECE_BYTES)
            yield await apart(partial(self._archive.read, _name(run, name), at, until))

    async def _round(self) -> str:
        """Bring what waits; what keeps one run's files from it, if anything does."""
        text, kept = "", False
        for run in self._files.to_keep(self._service):
            try:
                await self._keep(run)
                kept = True
            except (ArchiveAwayError, DatabaseAwayError):
                raise
            except (HilError, OSError) as error:
                text = f"run {run}: {error}"
        if kept or time.monotonic() - self._cleared_s > _CLEAR_S:
            await self._clear()
            self._cleared_s = time.monotonic()
        return text

    async def _keep(self, run: int) -> None:
        there = {file.name: file for file in self._files.of(run)}
        for path in files_in(folder_of(self._folder, run)):
            size, sha256 = path.stat().st_size, await apart(partial(sha256_of, path))
            if path.name in there and there[path.name] == KeptFile(path.name, size, sha256):
                continue
            kept: Kept = await apart(partial(self._archive.put, path, _name(run, path.name)))
            self._files.add(run, KeptFile(path.name, kept.size, kept.sha256))
        self._files.all_kept(run)
        logger.info("files of run %d are kept in %s", run, self._archive.shown)

    async def _clear(self) -> None:
        """Remove files here that the archive has, once they are old."""
        old = await apart(partial(_runs_until, self._folder, time.time() - self._local_s))
        shown = self._shown()
        for run in self._files.kept([run for run in old if run not in shown]):
            folder = folder_of(self._folder, run)
            sizes = {file.name: file.size for file in self._files.of(run)}
            for path in files_in(folder):
                if sizes.get(path.name) == path.stat().st_size:
                    path.unlink()
            if not files_in(folder):
                (folder / LOCK).unlink(missing_ok=True)
                with contextlib.suppress(OSError):  # something else lies there: it stays
                    folder.rmdir()


def _name(run: int, name: str) -> str:
    return f"{run:06d}/{name}"


def _runs_until(folder: Path, moment_s: float) -> list[int]:
    """Runs of whose files none was written after a moment; seconds since 1970."""
    folders = [one for one in folder.glob("[0-9]*") if one.name.isdecimal()]
    return [int(one.name) for one in folders if _touched_s(one) <= moment_s]


def _touched_s(folder: Path) -> float:
    """When something of it was written last, also by bringing it back; seconds since 1970."""
    with contextlib.suppress(OSError):
        return max((path.stat().st_mtime for path in files_in(folder)), default=0.0)
    return float("inf")
