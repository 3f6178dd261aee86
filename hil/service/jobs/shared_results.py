"""Studies, campaigns and given recordings, shared by the services of a database.

What one is stays in its service's folder, which works without the database. In rounds each service tells the
others of its own, and brings what they leave to the archive: whatever the moment at which it is killed, the
next round does what is missing. Others list them, and read their files from the archive.
"""

from __future__ import annotations

import contextlib
import logging
import shutil
from functools import partial
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from hil.api_schemas.api import Record
from hil.core.errors import HilError
from hil.core.files import make_directory, sha256_of
from hil.execution.background import apart
from hil.service.archive import Archive, ArchiveAwayError, Kept
from hil.service.jobs.job_repository import files_in_results
from hil.service.store import DatabaseAwayError, KeptFile, ResultKind, ResultStore, SharedJob

R = TypeVar("R", bound=Record)
_OF_THE_SERVICE = {"files", "place"}  # what each service says itself

logger = logging.getLogger(__name__)


class Own(Protocol[R]):
    """Those of this service."""

    def to_tell(self) -> list[R]:
        """All of them as they are now, without the names of their files."""

    def is_over(self, one: R) -> bool:
        """Whether it leaves no more files, as it is."""

    def is_removed(self, number: int) -> bool:
        """Whether one was here and is removed."""

    def results(self, number: int) -> Path:
        """Where the files of one are."""


class SharedResults(Generic[R]):
    """Those of a kind.

    Args:
        data: what one is read as.
        archive: where files are kept for all; None if each service keeps its own.
        folder: where files of others are brought to be read; emptied.
    """

    def __init__(
        self, store: ResultStore, kind: ResultKind, data: type[R], archive: Archive | None, folder: Path
    ) -> None:
        self._store, self._kind, self._data = store, kind, data
        self._archive, self._folder = archive, folder
        self._published: dict[int, str] | None = None  # as the database has it
        self._facts: dict[int, tuple[R, str]] = {}  # those that have not changed need not be written anew
        self._apart: set[int] = set()
        self.waiting = 0
        shutil.rmtree(folder, ignore_errors=True)

    def draw(self, above: int) -> int:
        """A number that no service has been given."""
        return self._store.draw(self._kind, above)

    def with_others(self, own: list[R]) -> list[R]:
        """Newest first; without those of others of which this service has another under the same number."""
        there = {one.id for one in own}
        return sorted((*own, *(one for one in self.others() if one.id not in there)), key=lambda one: -one.id)

    def others(self) -> list[R]:
        """Those of other services, newest first; none while the database is away."""
        with contextlib.suppress(DatabaseAwayError):
            found = self._store.others(self._kind)
            names = self._store.names(self._kind) if found and self._archive is not None else {}
            read = [self._read(published, names.get(published.id, [])) for published in found]
            return [one for one in read if one is not None]
        return []

    def other(self, number: int) -> R | None:
        """One of another service; None if there is none, or a newer version has written it."""
        published = self._store.other(self._kind, number)
        return (
            None if published is None else self._read(published, [file.name for file in self._files(number)])
        )

    async def bring(self, number: int, name: str) -> Path:
        """A file of another service's, here.

        Raises:
            ArchiveAwayError: the archive does not give it, or not as it was.
        """
        path = self._folder / f"{number:06d}" / name
        found = next((file for file in self._files(number) if file.name == name), None)
        if found is None or self._archive is None:
            raise ArchiveAwayError("the store has no such file", where=self._name(number, name))
        if not (path.is_file() and await apart(partial(sha256_of, path)) == found.sha256):
            make_directory(path.parent)
            wanted = Kept(found.size, found.sha256)
            await apart(partial(self._archive.get, self._name(number, name), path, wanted))
        return path

    async def bring_all(self, number: int) -> Path:
        """The folder with all files of another service's, here.

        Raises:
            ArchiveAwayError: the archive does not give them.
        """
        for file in self._files(number):
            await self.bring(number, file.name)
        return self._folder / f"{number:06d}"

    async def share(self, mine: Own[R]) -> str:
        """Tell of this service's own, bring what those that are over left to the archive, remove the removed.

        Returns:
            what keeps one of them from it, '' if nothing does.

        Raises:
            ArchiveAwayError: the archive does not answer.
            DatabaseAwayError: the database does not.
        """
        published = self._published = (
            self._store.mine(self._kind) if self._published is None else self._published
        )
        there = {one.id: one for one in mine.to_tell()}
        for number, one in there.items():
            facts = self._facts_of(one)
            if published.get(number) != facts and number not in self._apart:
                self._tell(number, facts, published)
        for number in [number for number in published if mine.is_removed(number)]:
            await self._remove(number)
            del published[number]
        wanted = [one for one in there.values() if one.id in published and mine.is_over(one)]
        return "" if self._archive is None else await self._keep(self._archive, wanted, mine, published)

    def _facts_of(self, one: R) -> str:
        before = self._facts.get(one.id)
        if before is None or before[0] is not one:
            before = self._facts[one.id] = one, one.model_dump_json(exclude=_OF_THE_SERVICE)
        return before[1]

    def _tell(self, number: int, facts: str, published: dict[int, str]) -> None:
        if self._store.tell(self._kind, number, facts):
            published[number] = facts
        else:
            self._apart.add(number)
            logger.warning(
                "%s %d is not shared: its number, of an earlier version, is that of another service's too",
                self._kind,
                number,
            )

    async def _keep(self, archive: Archive, wanted: list[R], mine: Own[R], published: dict[int, str]) -> str:
        missing = set(self._store.not_kept(self._kind))
        waiting = sorted(one.id for one in wanted if one.id in missing)
        self.waiting, text = len(waiting), ""
        for number in waiting:
            facts = published[number]
            try:
                await self._keep_files(archive, number, mine.results(number))
            except (ArchiveAwayError, DatabaseAwayError):
                raise
            except (HilError, OSError) as error:
                text = f"{self._kind} {number}: {error}"
                continue
            self._store.all_kept(self._kind, number, facts)
            self.waiting -= 1
        return text

    async def _keep_files(self, archive: Archive, number: int, results: Path) -> None:
        there = {file.name: file for file in self._files(number)}
        for name in files_in_results(results):
            path = results / name
            file = KeptFile(name, path.stat().st_size, await apart(partial(sha256_of, path)))
            if there.pop(name, None) == file:
                continue
            kept = await apart(partial(archive.put, path, self._name(number, name)))
            self._store.add_file(self._kind, number, KeptFile(name, kept.size, kept.sha256))
        for name in there:
            await self._drop(number, name)

    async def _remove(self, number: int) -> None:
        for file in self._files(number):
            await self._drop(number, file.name)
        self._store.remove(self._kind, number)

    async def _drop(self, number: int, name: str) -> None:
        if self._archive is not None:
            await apart(partial(self._archive.remove, self._name(number, name)))
        else:
            logger.warning("%s stays in the store, which this service has not", self._name(number, name))
        self._store.forget_file(self._kind, number, name)

    def _files(self, number: int) -> list[KeptFile]:
        return self._store.files(self._kind, number)

    def _read(self, published: SharedJob, names: list[str]) -> R | None:
        try:
            found = self._data.model_validate_json(published.facts)
        except ValueError:  # of a newer version
            logger.warning("%s %d cannot be read as its service tells it", self._kind, published.id)
            return None
        return found.model_copy(update={"place": published.place, "files": names if self._archive else []})

    def _name(self, number: int, name: str) -> str:
        return f"{_FOLDERS[self._kind]}/{number:06d}/{name}"


_FOLDERS: dict[ResultKind, str] = {"study": "studies", "campaign": "campaigns", "recording": "recordings"}
