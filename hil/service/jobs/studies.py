"""Identifications and diagnoses: `hil identify` and `hil diagnose`, one at a time, each in its own process.

Each has a folder with what was asked (`study.json`) and what came of it. One that was under way when the
service ended is interrupted: it can be asked for again, nothing of a bench hangs on it.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import logging
from collections.abc import Sequence
from pathlib import Path

from hil.core.errors import BadInputError
from hil.messages.study import STUDY_OVER, StudyData, StudyKind
from hil.service.jobs.command_process import CommandProcess, kill_left
from hil.service.jobs.job_repository import JobRepository, files_in_results
from hil.service.jobs.shared_results import SharedResults
from hil.service.store import in_turns

_AT_ONCE = 1  # a run needs the other processor
_LAST_WORDS_S = 20.0
_MOST_WAITING = 20
_RESULTS = "results"

logger = logging.getLogger(__name__)


class Studies:
    """All of them, by number.

    Args:
        folder: where each has a folder of its own.
        command: starts the command line.
        shared: those of other services.
    """

    def __init__(self, folder: Path, command: Sequence[str], shared: SharedResults[StudyData]) -> None:
        self._command, self._shared = command, shared
        self._turn = asyncio.Semaphore(_AT_ONCE)
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._processes: dict[int, CommandProcess] = {}
        self._closing = False
        self._records = JobRepository(folder, "study.json", StudyData, shared.draw)
        for study in self._records:
            if study.state not in STUDY_OVER:
                kill_left(self._records.folder_of(study.id), self.results(study.id))
                self._end(study.id, "interrupted", "the service ended during the study; start it again")

    def all(self, kind: StudyKind | None = None) -> list[StudyData]:
        """Newest first, also those of other services."""
        return [study for study in self._shared.with_others(self.own()) if kind in (None, study.kind)]

    def get(self, number: int) -> StudyData | None:
        """One of them."""
        found = self._records.get(number)
        return self._shared.other(number) if found is None else self._shown(found)

    def own(self) -> list[StudyData]:
        """Those of this service, newest first."""
        return [self._shown(study) for study in self._records]

    def to_tell(self) -> list[StudyData]:
        """Those of this service, without the names of their files."""
        return list(self._records)

    def is_over(self, one: StudyData) -> bool:
        """Whether it leaves no more files."""
        return one.state in STUDY_OVER

    def is_removed(self, number: int) -> bool:
        """Whether one was here and is removed."""
        return self._records.is_removed(number)

    def results(self, number: int) -> Path:
        """Where the files of one of this service are."""
        return self._records.folder_of(number) / _RESULTS

    async def file(self, number: int, name: str) -> Path:
        """A file of one, brought here if it is another service's.

        Raises:
            ArchiveAwayError: the archive does not give it.
        """
        here = self._records.get(number) is not None
        return self.results(number) / name if here else await self._shared.bring(number, name)

    async def files(self, number: int) -> Path:
        """The folder with all files of one, brought here if it is another service's.

        Raises:
            ArchiveAwayError: the archive does not give them.
        """
        here = self._records.get(number) is not None
        return self.results(number) if here else await self._shared.bring_all(number)

    async def share(self) -> str:
        """Tell other services of them, and keep their files for all; what keeps one from it."""
        return await self._shared.share(self)

    @property
    def not_stored(self) -> int:
        """How many that are over have files which the archive has not."""
        return self._shared.waiting

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
            raise BadInputError(
                f"{_MOST_WAITING} studies are already queued", where=kind, fix="cancel one of them"
            )
        number = self._records.take_number()
        study = StudyData(
            id=number,
            kind=kind,
            state="waiting",
            runs=runs,
            model=model,
            requested_by=by,
            asked_at=datetime.datetime.now(datetime.UTC),
        )
        self._records.keep(study)
        self._tasks[number] = asyncio.create_task(in_turns(self._carried_out(number, arguments, within_s)))
        return study

    async def cancel(self, number: int) -> bool:
        """End one; what a diagnosis knows by then it writes down. False if it is over."""
        task = self._tasks.get(number)
        if task is None:
            return False
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task
        return True

    def remove(self, number: int) -> bool:
        """Remove one that is over, with its files; False if it is not over."""
        found = self._records.get(number)
        if found is None or found.state not in STUDY_OVER or number in self._tasks:
            return False
        self._records.remove(number)
        return True

    async def close(self) -> None:
        """End all that are under way; a service that begins again finds them interrupted."""
        self._closing = True
        for number, process in self._processes.items():
            logger.info("study %d is ended with the service", number)
            process.kill()
        for task in self._tasks.values():
            task.cancel()
        await asyncio.gather(*self._tasks.values(), return_exceptions=True)

    async def _carried_out(self, number: int, arguments: Sequence[str], within_s: float) -> None:
        try:
            async with self._turn:
                self._records.change(number, state="running")
                code, said = await self._command_ended(number, arguments, within_s)
            if code == 0:
                self._end(number, "ended")
            else:
                self._end(number, "failed", said)
        except asyncio.CancelledError:
            self._end(number, "cancelled", "cancelled")
            raise
        except OSError as error:
            self._end(number, "failed", str(error))
        finally:
            self._tasks.pop(number, None)

    async def _command_ended(self, number: int, arguments: Sequence[str], within_s: float) -> tuple[int, str]:
        folder, results = self._records.folder_of(number), self.results(number)
        process = await CommandProcess.begin([*self._command, *arguments], folder, results)
        self._processes[number] = process
        try:
            return await asyncio.wait_for(process.over(), within_s)
        except TimeoutError:
            return 3, f"took more than {within_s:g} s"
        finally:
            await process.end(_LAST_WORDS_S)
            del self._processes[number]

    def _end(self, number: int, state: str, reason: str = "") -> None:
        if not self._closing:
            now = datetime.datetime.now(datetime.UTC)
            self._records.change(number, state=state, reason=reason, ended_at=now)

    def _shown(self, study: StudyData) -> StudyData:
        if study.state not in STUDY_OVER:
            return study
        return study.model_copy(update={"files": files_in_results(self.results(study.id))})
