"""Jobs of the service: by number, in turn, each in a process and a folder of its own, shared with others.

A folder has what one is (`state.json`), what was asked (`request.json`) and what comes of it (`results/`).
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import logging
from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Coroutine
from pathlib import Path
from typing import Any, Generic, TypeVar, cast

from hil.api_schemas.campaign import CampaignData
from hil.api_schemas.study import StudyData
from hil.core.errors import BadInputError
from hil.service.jobs.job_repository import JobProcess, JobRepository, files_in_results
from hil.service.jobs.shared_results import SharedResults
from hil.service.store import in_turns

_AT_ONCE = 1  # a run needs the other processor
_MOST_WAITING = 20
_RESULTS = "results"
OVER = ("ended", "failed", "cancelled", "interrupted")
J = TypeVar("J", bound=StudyData | CampaignData)

logger = logging.getLogger(__name__)


class Jobs(ABC, Generic[J]):
    """Jobs of one kind.

    Args:
        folder: where each has a folder of its own.
        file: name of the file that says what one is.
        data: what that file is read as.
        shared: those of other services.
        name, plural: what one is called, in messages.
    """

    def __init__(
        self, folder: Path, file: str, data: type[J], shared: SharedResults[J], name: str, plural: str
    ) -> None:
        self._shared, self._name, self._plural = shared, name, plural
        self._turn = asyncio.Semaphore(_AT_ONCE)
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._processes: dict[int, JobProcess] = {}
        self._closing = False
        self._records = JobRepository(folder, file, data, shared.draw)

    @abstractmethod
    def _progress(self, number: int) -> dict[str, Any]:
        """What has changed of one that is under way since it was written down."""

    def all(self) -> list[J]:
        """Newest first, also those of other services."""
        return self._shared.with_others(self.own())

    def get(self, number: int) -> J | None:
        """One of them."""
        found = self._records.get(number)
        return self._shared.other(number) if found is None else self._shown(found)

    def own(self) -> list[J]:
        """Those of this service, newest first."""
        return [self._shown(job) for job in self._records]

    def to_tell(self) -> list[J]:
        """Those of this service as they are now, without the names of their files."""
        return [job if self.is_over(job) else self._with_progress(job) for job in self._records]

    def _with_progress(self, job: J) -> J:
        changes = self._progress(job.id)
        return cast(J, job.model_copy(update=changes)) if changes else job

    def is_over(self, job: J) -> bool:
        """Whether it leaves no more files, unless it is resumed."""
        return job.state in OVER

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

    async def cancel(self, number: int) -> bool:
        """End one; what it knows by then it writes down. False if it is over."""
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
        if found is None or not self.is_over(found) or number in self._tasks:
            return False
        self._records.remove(number)
        return True

    async def close(self) -> None:
        """End all that are under way, with the service."""
        self._closing = True
        for number, process in self._processes.items():
            logger.info("%s %d is ended with the service", self._name, number)
            process.kill()
        for task in self._tasks.values():
            task.cancel()
        await asyncio.gather(*self._tasks.values(), return_exceptions=True)

    def _refuse_too_many(self) -> None:
        """Raises:
        BadInputError: too many wait already.
        """
        if len(self._tasks) >= _MOST_WAITING:
            what = f"{_MOST_WAITING} {self._plural} are already queued"
            raise BadInputError(what, where=self._name, fix="cancel one of them")

    def _begin(self, number: int, work: Coroutine[Any, Any, None]) -> None:
        """Carry one out in its turn."""
        self._tasks[number] = asyncio.create_task(in_turns(self._in_turn(number, work)))

    async def _in_turn(self, number: int, work: Coroutine[Any, Any, None]) -> None:
        try:
            async with self._turn:
                await work
        finally:
            work.close()
            self._tasks.pop(number, None)

    @contextlib.asynccontextmanager
    async def _process(self, number: int, request: object, last_words_s: float) -> AsyncIterator[JobProcess]:
        """The process of one; it is ended with the block."""
        process = await JobProcess.begin(request, self._records.folder_of(number))
        self._processes[number] = process
        try:
            yield process
        finally:
            await process.end(last_words_s)
            del self._processes[number]

    def _change(self, number: int, **changes: object) -> None:
        """Write down what came of one, unless the service is closing: then the next one has to."""
        if not self._closing:
            self._records.change(number, **changes, ended_at=datetime.datetime.now(datetime.UTC))

    def _shown(self, job: J) -> J:
        if not self.is_over(job):
            return self._with_progress(job)
        return cast(J, job.model_copy(update={"files": files_in_results(self.results(job.id))}))
