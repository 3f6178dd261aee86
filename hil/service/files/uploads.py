"""Uploaded files, shared by the services of a database: rows of it, with a folder as their cache.

A file is written from its row when it is looked for and is not that; what has no row is no file. So
whatever the moment at which a service is killed, and whoever gave or removed it, it is the row that counts.
"""

from __future__ import annotations

import datetime
from pathlib import Path

from hil.api_schemas.upload import GivenKind
from hil.core.errors import BadInputError
from hil.core.files import make_directory, of_the_system, sha256_of, write_atomically
from hil.service.store import GivenStore, GivenText, asked_apart


class NameTakenError(BadInputError):
    """A name stands for another content."""


@asked_apart
class Uploads:
    """Those of a kind, by name.

    Every method raises DatabaseAwayError if the database does not answer, and HilError if the folder cannot
    be written.

    Args:
        folder: of the cache; files of other kinds may lie there with other endings.
        ending: of their names, with the point.
    """

    def __init__(self, store: GivenStore, kind: GivenKind, folder: Path, ending: str) -> None:
        self._store, self.kind, self.folder, self._ending = store, kind, folder, ending
        make_directory(folder)

    def paths(self) -> dict[str, Path]:
        """All of them by name, each as it is in the database; others are removed from the folder."""
        wanted = self._store.all(self.kind)
        for path in self.folder.glob(f"[!.]*{self._ending}"):
            if path.name.removesuffix(self._ending) not in wanted:
                _gone(path)
        found = {name: self._fresh(name, sha256) for name, sha256 in wanted.items()}
        return {name: path for name, path in found.items() if path is not None}

    def path(self, name: str) -> Path | None:
        """Where one is, as it is in the database; None if there is none."""
        found = self.text(name)
        if found is None:
            _gone(self._place(name))
            return None
        return self._written(found)

    def text(self, name: str) -> GivenText | None:
        """One as it is in the database; None if there is none."""
        found = self._store.get(self.kind, name)
        return None if found is None or found.removed else found

    def give(
        self,
        name: str,
        text: str,
        by: str,
        *,
        instead_of: GivenText | None = None,
        based_on: str = "",
        fix: str = "give it another name",
    ) -> Path:
        """Keep one; the same text may be given again. Where it is.

        Args:
            by: who gives it.
            instead_of: what it replaces, as it was looked at; None if the name has to be free.
            based_on: name of the one that it was made from.
            fix: what to do if it is not, or if that was replaced meanwhile.

        Raises:
            NameTakenError: the name stands for another content.
        """
        replaced = "" if instead_of is None else instead_of.sha256
        kept = self._store.give(self.kind, name, text, by, instead_of=replaced, based_on=based_on)
        path = self.path(name)
        if not kept or path is None:
            there = self.text(name)
            giver = f", given by {giver_of(there)}" if there is not None and there.given_by else ""
            raise NameTakenError(f"is already used for other content{giver}", where=name, fix=fix)
        return path

    def remove(self, name: str) -> bool:
        """Remove one; false if there is none."""
        removed = self._store.remove(self.kind, name)
        if removed:
            _gone(self._place(name))
        return removed

    def _fresh(self, name: str, sha256: str) -> Path | None:
        path = self._place(name)
        return path if path.is_file() and sha256_of(path) == sha256 else self.path(name)

    def _written(self, found: GivenText) -> Path:
        path = self._place(found.name)
        if not path.is_file() or sha256_of(path) != found.sha256:
            write_atomically(path, found.text)
        return path

    def _place(self, name: str) -> Path:
        return self.folder / f"{name}{self._ending}"


def giver_of(there: GivenText) -> str:
    """Who gave it, and when."""
    at = there.given_at.astimezone(datetime.UTC)
    return f"{there.given_by or 'somebody'} at {at:%Y-%m-%d %H:%M} UTC"


def _gone(path: Path) -> None:
    """Remove a file, whoever else may be doing so."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise of_the_system(error) from error
