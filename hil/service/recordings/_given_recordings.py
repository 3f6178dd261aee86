"""All recordings that people have given: a folder each, with what it is and the file.

Pieces gather in a hidden file. When it is whole it is moved to the results and read by another process; only
then is it there for studies, and for other services.
"""

from __future__ import annotations

import asyncio
import datetime
import logging
import time
from functools import partial
from pathlib import Path
from typing import Any

from hil.api_schemas.recording import RecordingData, RecordingWanted
from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.recording import NOT_READ, READ
from hil.execution.background import apart
from hil.service.jobs.job_repository import JobRepository, files_in_results
from hil.service.jobs.shared_results import SharedResults
from hil.service.plain_words import in_plain_words
from hil.service.recordings._pieces import add_piece, size_of, take_whole
from hil.service.recordings._room import Room
from hil.service.store import in_turns
from hil.service.worker_pool import READING, TooLongError, WorkerPool

_RESULTS = "results"
_ARRIVING = "arriving"
_READ_WITHIN_S, _WITHIN_S = 300.0, 900.0
#: After this long without a piece one that is arriving is given up.
_GIVEN_UP_S = 24 * 3600.0
_READ_FIELDS = ("samples", "duration_s", "channel_count", "channels", "plan", "notes", "used")

logger = logging.getLogger(__name__)


class GivenRecordings:
    """All of them, by number.

    Args:
        folder: where each has a folder of its own.
        shared: those of other services.
    """

    def __init__(self, folder: Path, shared: SharedResults[RecordingData], room: Room | None = None) -> None:
        self._folder, self._shared, self._room = folder, shared, room or Room()
        self._records = JobRepository(folder, "recording.json", RecordingData, shared.draw)
        # Ended after each file: what a hostile one has done to it goes with it.
        self._reading = WorkerPool(niceness=10, read_within_s=_READ_WITHIN_S, within_s=_WITHIN_S)
        self._turn = asyncio.Semaphore(1)
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._closing = False

    def all(self) -> list[RecordingData]:
        """Newest first, also those of other services; without what makes a long list of them heavy."""
        found = self._shared.with_others([self._shown(one) for one in self._records])
        return [one.model_copy(update={"channels": [], "notes": []}) for one in found]

    def get(self, number: int) -> RecordingData | None:
        """One of them."""
        found = self._records.get(number)
        return self._shared.other(number) if found is None else self._shown(found)

    def begin(self, wanted: RecordingWanted, by: str) -> RecordingData:
        """Have one arrive.

        Raises:
            BadInputError: nothing reads such a file, or there is no room for it.
        """
        _refuse_other_kinds(wanted.name)
        self._give_up_old()
        there = [self._shown(one) for one in self._records]
        self._room.refuse_too_much(wanted.size, by, wanted.name, there, self._folder)
        one = RecordingData(
            id=self._records.take_number(),
            name=wanted.name,
            size=wanted.size,
            received=0,
            state="arriving",
            columns=wanted.columns,
            given_by=by,
            given_at=datetime.datetime.now(datetime.UTC),
        )
        return self._records.keep(one)

    def add(self, one: RecordingData, at: int, piece: bytes, sha256: str) -> int:
        """Add a piece of one that is arriving; how much of it is there.

        Raises:
            BadInputError: the piece is not what its SHA-256 says, or too long.
            BenchError: it cannot be written.
        """
        return add_piece(self._arriving(one.id), one.name, at, piece, sha256, one.size)

    def check(
        self, one: RecordingData, *, sha256: str | None = None, columns: list[str] | None = None
    ) -> RecordingData:
        """Have one compared with its SHA-256 and read, whether anew or for the first time.

        Args:
            sha256: of the whole, if its pieces have just come.
            columns: in place of those that it was given with.
        """
        changes: dict[str, Any] = {"state": "checking", "reason": ""}
        changes |= {} if sha256 is None else {"sha256": sha256}
        changes |= {} if columns is None else {"columns": columns}
        changed = self._records.change(one.id, **changes)
        self._begin_check(one.id)
        return self._shown(changed)

    def is_here(self, one: RecordingData) -> bool:
        """Whether its file has come whole."""
        return (self.results(one.id) / one.name).is_file()

    def go_on(self) -> None:
        """Go on with what a service before this one was checking."""
        for one in self._records:
            if one.state == "checking":
                self._begin_check(one.id)

    def remove(self, number: int) -> bool:
        """Remove one with its files; false while it is checked."""
        if number in self._tasks:
            return False
        self._records.remove(number)
        return True

    async def file(self, one: RecordingData, name: str = "") -> Path:
        """A file of one, by default that which studies read; brought here if it is another service's.

        Raises:
            ArchiveAwayError: the archive does not give it.
        """
        if self._records.get(one.id) is None:
            return await self._shared.bring(one.id, name or one.used)
        return self.results(one.id) / (name or one.used)

    async def share(self) -> str:
        """Tell other services of those that are ready, and keep their files for all."""
        return await self._shared.share(self)

    @property
    def not_stored(self) -> int:
        """How many have files which the archive has not."""
        return self._shared.waiting

    def to_tell(self) -> list[RecordingData]:
        """Those that are ready."""
        return [one for one in self._records if one.state == "ready"]

    def is_over(self, one: RecordingData) -> bool:
        """Whether its files stay as they are."""
        return one.state == "ready"

    def is_removed(self, number: int) -> bool:
        """Whether one was here and is removed."""
        return self._records.is_removed(number)

    def results(self, number: int) -> Path:
        """Where the files of one of this service are."""
        return self._records.folder_of(number) / _RESULTS

    async def close(self) -> None:
        """End the reading; the next service goes on with it."""
        self._closing = True
        self._reading.close()
        for task in self._tasks.values():
            task.cancel()
        await asyncio.gather(*self._tasks.values(), return_exceptions=True)

    def _begin_check(self, number: int) -> None:
        self._tasks[number] = asyncio.create_task(in_turns(self._check_in_turn(number)))

    async def _check_in_turn(self, number: int) -> None:
        try:
            async with self._turn:
                await self._check(number)
        finally:
            self._tasks.pop(number, None)

    async def _check(self, number: int) -> None:
        one = self._records.get(number)
        assert one is not None, "one that is checked is not removed"
        place = self.results(number) / one.name
        try:
            if not await apart(partial(take_whole, self._arriving(number), one.sha256, place)):
                self._refuse(number, "it did not arrive as it was sent: its SHA-256 differs; give it again")
                return
            found = await self._reading.ask(f"{READING}recording", path=str(place), columns=one.columns)
            self._records.change(
                number, state="ready", received=one.size, **{name: found[name] for name in _READ_FIELDS}
            )
        except BadInputError as error:
            self._refuse(number, _in_words(error, place, one.name))
        except TooLongError:
            self._refuse(number, f"reading it takes more than {_READ_WITHIN_S:g} s of a processor")
        except (HilError, OSError) as error:
            if not self._closing:
                logger.warning("recording %d cannot be checked: %s", number, error)
                why = error.what if isinstance(error, BenchError) else str(error)
                self._refuse(number, f"it cannot be read here: {why}")
        finally:
            self._reading.close()

    def _refuse(self, number: int, reason: str) -> None:
        self._records.change(number, state="refused", reason=reason)

    def _give_up_old(self) -> None:
        """Remove those that have been arriving for so long that no one sends them any more."""
        now_s = time.time()
        for one in list(self._records):
            path = self._arriving(one.id)
            last_s = path.stat().st_mtime if path.exists() else one.given_at.timestamp()
            if one.state == "arriving" and now_s - last_s > _GIVEN_UP_S:
                logger.info("recording %d has not arrived for a day and is removed", one.id)
                self._records.remove(one.id)

    def _arriving(self, number: int) -> Path:
        return self._records.folder_of(number) / _ARRIVING

    def _shown(self, one: RecordingData) -> RecordingData:
        if one.state == "arriving":
            return one.model_copy(update={"received": size_of(self._arriving(one.id))})
        files = files_in_results(self.results(one.id)) if one.state == "ready" else []
        return one.model_copy(update={"received": one.size, "files": files})


def _refuse_other_kinds(name: str) -> None:
    ending = Path(name).suffix.lower()
    if ending not in READ:
        what, fix = NOT_READ.get(ending, ("", "rename or convert the file"))
        known = f"recordings end in {', '.join(READ)}"
        raise BadInputError(f"is {what}: {known}" if what else known, where=name, fix=fix)


def _in_words(error: BadInputError, path: Path, name: str) -> str:
    """The error, in which the file is called as it was given."""
    text = f"{error.where}: {error.what}" if error.where else error.what
    return in_plain_words(f"{text}; {error.fix}" if error.fix else text, {str(path): name})
