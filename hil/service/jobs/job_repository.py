"""Jobs on the disk: a folder with a file for each number, and the process that does the work.

The next service finds that process if this one is killed.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import shutil
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Generic, TypeVar

from hil.api_schemas.api import Record
from hil.app.worker.job import JOB, write_request
from hil.core.files import make_directory, write_atomically
from hil.execution.background import STUDY_BYTES, start_process

_NICENESS = 10
_NUMBER = "process"


class JobProcess:
    """A job under way; `begin` makes one."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    @classmethod
    async def begin(cls, request: object, folder: Path) -> JobProcess:
        """Begin one; what is wanted, and the number of its process, are kept in `folder`.

        Raises:
            HilError: the folder cannot be written.
            OSError: it cannot be started.
        """
        write_request(folder, request)
        process = await start_process(
            *JOB,
            str(folder.resolve()),
            niceness=_NICENESS,
            most_bytes=STUDY_BYTES,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        write_atomically(folder / _NUMBER, str(process.pid))
        return cls(process)

    async def over(self) -> tuple[int, str]:
        """Its exit code, and why it failed, once it has ended."""
        _, complaint = await self._process.communicate()
        code = self._process.returncode or 0
        reason = complaint.decode("utf-8", "replace").removeprefix("error: ").strip() if code else ""
        return code, reason or f"exit code {code}"

    def interrupt(self) -> None:
        """As Ctrl-C: it writes what it knows and ends; twice, it ends at once."""
        with contextlib.suppress(ProcessLookupError):
            self._process.send_signal(signal.SIGINT)

    def kill(self) -> None:
        """End it and whatever it has started, now."""
        if self._process.returncode is None:
            _kill_session(self._process.pid)

    async def end(self, within_s: float) -> None:
        """Interrupt it, and kill it if it takes longer."""
        if self._process.returncode is not None:
            return
        self.interrupt()
        try:
            await asyncio.wait_for(self._process.communicate(), within_s)
        except TimeoutError:
            self.kill()
            await self._process.wait()


def kill_left(folder: Path) -> None:
    """End the process that a killed service has left at work in this folder."""
    with contextlib.suppress(OSError, ValueError):
        process = int((folder / _NUMBER).read_text("utf-8"))
        called = Path(f"/proc/{process}/cmdline").read_bytes()
        if os.fsencode(folder.resolve()) in called.split(b"\0"):
            _kill_session(process)


def _kill_session(process: int) -> None:
    """`started` gave it a session of its own, and so a group that has its number."""
    with contextlib.suppress(OSError):
        os.killpg(process, signal.SIGKILL)


logger = logging.getLogger(__name__)


R = TypeVar("R", bound=Record)


class JobRepository(Generic[R]):
    """All of them. What is changed is on disk before it counts. One process has a folder (`alone_in`).

    Args:
        folder: where each has a folder of its own.
        file: name of the file that says what one is.
        kind: what the file is read as; one that cannot be read is left out, and its number is taken.
        draw: gives a new number above the one that it is given; without it numbers are this folder's own.
    """

    def __init__(
        self, folder: Path, file: str, kind: type[R], draw: Callable[[int], int] = lambda last: last + 1
    ) -> None:
        self._folder, self._file, self._kind, self._draw = folder, file, kind, draw
        make_directory(folder)
        self._known = {record.id: record for record in self._read()}
        folders = [path for path in folder.glob("[0-9]" * 6) if path.is_dir()]
        self._last = max((int(path.name) for path in folders), default=0)
        for path in folders:
            if not (path / file).exists():
                _empty(path)  # whoever removed it, or was beginning it, was killed

    def __iter__(self) -> Iterator[R]:
        """Newest first."""
        yield from sorted(self._known.values(), key=lambda record: -record.id)

    def get(self, number: int) -> R | None:
        """One of them; None if there is none of this number."""
        return self._known.get(number)

    def folder_of(self, number: int) -> Path:
        """Where everything of one is."""
        return self._folder / f"{number:06d}"

    def take_number(self) -> int:
        """A number for a new one.

        Raises:
            DatabaseAwayError: the database gives them, and does not answer.
        """
        self._last = self._draw(self._last)
        return self._last

    def keep(self, record: R) -> R:
        """Write one down, new or changed."""
        make_directory(self.folder_of(record.id))
        write_atomically(self.folder_of(record.id) / self._file, record.model_dump_json(indent=1))
        self._known[record.id] = record
        return record

    def change(self, number: int, **changes: object) -> R:
        """Write down what has changed of one."""
        return self.keep(self._known[number].model_copy(update=changes))

    def remove(self, number: int) -> None:
        """Remove one with all its files; its number is not given again."""
        folder = self.folder_of(number)
        (folder / self._file).unlink()  # first: without it there is none, whatever happens next
        del self._known[number]
        _empty(folder)

    def is_removed(self, number: int) -> bool:
        """Whether one was here and is removed; one whose folder is lost was not."""
        folder = self.folder_of(number)
        return number not in self._known and folder.is_dir() and not any(folder.iterdir())

    def _read(self) -> Iterator[R]:
        for path in sorted(self._folder.glob(f"[0-9]*/{self._file}")):
            try:
                yield self._kind.model_validate_json(path.read_bytes())
            except (OSError, ValueError) as error:
                logger.warning("%s cannot be read: %s", path, error)


def _empty(folder: Path) -> None:
    """Leave nothing in it, as far as that goes."""
    for path in folder.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def files_in_results(results: Path) -> list[str]:
    """Names of the files that a command has left there."""
    if not results.is_dir():
        return []
    return sorted(path.name for path in results.iterdir() if path.is_file() and path.name[0] != ".")
