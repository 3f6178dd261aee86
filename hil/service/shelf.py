"""Models and controllers of a service: those that are built in, and those that people gave."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Generic, TypeVar

from hil.core.errors import BadInputError
from hil.core.files import make_directory, read_text, write_atomically

T = TypeVar("T")


class Shelf(Generic[T]):
    """Files of one kind by name. A name stands for one content: who wants to change it gives a new name.

    Args:
        folder: where those that are given are kept, as `<name>.toml`.
        built_in: files that are always there.
        parse: makes of a file's text what it says; BadInputError if it cannot be used.
    """

    def __init__(self, folder: Path, built_in: Mapping[str, Path], parse: Callable[[str, str], T]) -> None:
        self._folder, self._built_in, self._parse = folder, dict(built_in), parse
        make_directory(folder)

    def __iter__(self) -> Iterator[str]:
        """All names, those that are built in first."""
        yield from self._built_in
        yield from sorted(path.stem for path in self._folder.glob("[!.]*.toml"))

    def is_built_in(self, name: str) -> bool:
        """Whether it is always there."""
        return name in self._built_in

    def path(self, name: str) -> Path | None:
        """Where it is; None if there is none."""
        if name in self._built_in:
            return self._built_in[name]
        path = self._folder / f"{name}.toml"
        return path if path.parent == self._folder and path.is_file() else None

    def get(self, name: str) -> T | None:
        """What it says; None if there is none.

        Raises:
            BadInputError: it cannot be read any more.
        """
        path = self.path(name)
        return None if path is None else self._parse(read_text(path), path.name)

    def give(self, name: str, text: str) -> T:
        """Keep one; the same text may be given again.

        Raises:
            BadInputError: it cannot be used, or the name stands for another.
        """
        path = self.path(name)
        if path is not None and (self.is_built_in(name) or read_text(path) != text):
            raise BadInputError("stands for another content already", where=name, fix="give it another name")
        found = self._parse(text, f"{name}.toml")
        write_atomically(self._folder / f"{name}.toml", text)
        return found

    def remove(self, name: str) -> bool:
        """Remove one that was given; false if there is none."""
        path = self.path(name)
        if path is None or self.is_built_in(name):
            return False
        path.unlink(missing_ok=True)
        return True
