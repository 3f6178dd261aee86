"""Jobs by number: each has a folder with a file that describes it."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Generic, TypeVar

from hil.api_schemas.api import Record
from hil.core.files import make_directory, write_atomically

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
