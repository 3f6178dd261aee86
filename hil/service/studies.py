"""Identifications and diagnoses: `hil identify` and `hil diagnose`, one at a time, each in its own process.

Each has a folder with what was asked (`study.json`) and what came of it. One that was under way when the
service ended is interrupted: it can be asked for again, nothing of a bench hangs on it.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import logging
import os
import signal
from collections.abc import Sequence
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import make_directory, write_atomically
from hil.service.background import begun
from hil.service.study_data import STUDY_OVER, StudyData, StudyKind

_AT_ONCE = 1  # a run needs the other processor
_NICENESS = 10
_LAST_WORDS_S = 20.0
_MOST_WAITING = 20
_FILE, _RESULTS, _PROCESS = "study.json", "results", "process"

logger = logging.getLogger(__name__)


class Studies:
    """All of them, by number.

    Args:
        folder: where each has a folder of its own.
        command: starts the command line.
    """

    def __init__(self, folder: Path, command: Sequence[str]) -> None:
        self._folder, self._command = folder, command
        self._turn = asyncio.Semaphore(_AT_ONCE)
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._processes: dict[int, asyncio.subprocess.Process] = {}
        self._closing = False
        make_directory(folder)
        self._known = {study.id: study for study in self._read()}
        for study in list(self._known.values()):
            if study.state not in STUDY_OVER:
                self._kill_left(study.id)
                self._end(study.id, "interrupted", "the service ended meanwhile; ask for it again")

    def all(self, kind: StudyKind | None = None) -> list[StudyData]:
        """Newest first."""
        found = [self._shown(study) for study in self._known.values() if kind in (None, study.kind)]
        return sorted(found, key=lambda study: -study.id)

    def get(self, number: int) -> StudyData | None:
        """One of them."""
        found = self._known.get(number)
        return None if found is None else self._shown(found)

    def results(self, number: int) -> Path:
        """Where the files of one are."""
        return self._of(number) / _RESULTS

    def begin(
        self, kind: StudyKind, runs: list[int], model: str, by: str, arguments: Sequence[str], within_s: float
    ) -> StudyData:
        """Have one carried out in its turn.

        Args:
            arguments: of the command line, but for where results go.
            within_s: how long it may take.

        Raises:
            BadInputError: too many wait already.
        """
        if len(self._tasks) >= _MOST_WAITING:
            raise BadInputError(f"{_MOST_WAITING} wait already", where=kind, fix="cancel one of them")
        number = max(self._known, default=0) + 1
        self._keep(
            StudyData(
                id=number,
                kind=kind,
                state="waiting",
                runs=runs,
                model=model,
                requested_by=by,
                asked_at=datetime.datetime.now(datetime.UTC),
            )
        )
        self._tasks[number] = asyncio.create_task(self._carried_out(number, arguments, within_s))
        return self._known[number]

    async def cancel(self, number: int) -> bool:
        """End one; what a diagnosis knows by then it writes down. False if it is over."""
        task = self._tasks.get(number)
        if task is None:
            return False
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task
        return True

    async def close(self) -> None:
        """End all that are under way; a service that begins again finds them interrupted."""
        self._closing = True
        for number, process in self._processes.items():
            logger.info("study %d is ended with the service", number)
            with contextlib.suppress(ProcessLookupError):
                process.kill()
        for task in self._tasks.values():
            task.cancel()
        await asyncio.gather(*self._tasks.values(), return_exceptions=True)

    async def _carried_out(self, number: int, arguments: Sequence[str], within_s: float) -> None:
        try:
            async with self._turn:
                self._keep(self._known[number].model_copy(update={"state": "running"}))
                code, said = await self._command_ended(number, arguments, within_s)
            if code == 0:
                self._end(number, "ended")
            else:
                self._end(number, "failed", said.removeprefix("error: ").strip() or f"exit code {code}")
        except asyncio.CancelledError:
            self._end(number, "cancelled", "cancelled")
            raise
        except OSError as error:
            self._end(number, "failed", str(error))
        finally:
            self._tasks.pop(number, None)

    async def _command_ended(self, number: int, arguments: Sequence[str], within_s: float) -> tuple[int, str]:
        process = await begun(
            *self._command,
            *arguments,
            "--out",
            str(self.results(number).resolve()),
            "--json",
            niceness=_NICENESS,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        self._processes[number] = process
        write_atomically(self._of(number) / _PROCESS, str(process.pid))
        try:
            _, said = await asyncio.wait_for(process.communicate(), within_s)
            return process.returncode or 0, said.decode("utf-8", "replace")
        except TimeoutError:
            return 3, f"took more than {within_s:g} s"
        finally:
            await _ended(process)
            del self._processes[number]

    def _kill_left(self, number: int) -> None:
        """End the process of a service that was killed: the one that writes into this study's folder."""
        with contextlib.suppress(OSError, ValueError):
            process = int((self._of(number) / _PROCESS).read_text("utf-8"))
            called = Path(f"/proc/{process}/cmdline").read_bytes()
            if os.fsencode(self.results(number).resolve()) in called.split(b"\0"):
                os.kill(process, signal.SIGKILL)

    def _end(self, number: int, state: str, reason: str = "") -> None:
        if self._closing:
            return
        now = datetime.datetime.now(datetime.UTC)
        self._keep(self._known[number].model_copy(update={"state": state, "reason": reason, "ended_at": now}))

    def _keep(self, study: StudyData) -> None:
        self._known[study.id] = study
        make_directory(self._of(study.id))
        write_atomically(self._of(study.id) / _FILE, study.model_dump_json(indent=1))

    def _shown(self, study: StudyData) -> StudyData:
        folder = self.results(study.id)
        if study.state not in STUDY_OVER or not folder.is_dir():
            return study
        names = sorted(path.name for path in folder.iterdir() if path.is_file() and path.name[0] != ".")
        return study.model_copy(update={"files": names})

    def _of(self, number: int) -> Path:
        return self._folder / f"{number:06d}"

    def _read(self) -> list[StudyData]:
        found = []
        for path in sorted(self._folder.glob(f"[0-9]*/{_FILE}")):
            try:
                found.append(StudyData.model_validate_json(path.read_bytes()))
            except (OSError, ValueError) as error:
                logger.warning("%s cannot be read: %s", path, error)
        return found


async def _ended(process: asyncio.subprocess.Process) -> None:
    """Asked to end as by Ctrl-C, so that it writes what it knows, and killed if it does not."""
    if process.returncode is not None:
        return
    with contextlib.suppress(ProcessLookupError):
        process.send_signal(signal.SIGINT)
    try:
        await asyncio.wait_for(process.communicate(), _LAST_WORDS_S)
    except TimeoutError:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()
