"""What people gave: plans, controllers, models and bench files, each a row with its text; and versions."""

from __future__ import annotations

import datetime
import hashlib
from dataclasses import dataclass

from sqlalchemy import Engine, or_, select, update
from sqlalchemy.orm import Session, sessionmaker

from hil.api_schemas.upload import GivenKind
from hil.core.errors.wording import shortened
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now
from hil.service.store._tables import GivenRow, put
from hil.service.store._versions import add_version


@dataclass(frozen=True)
class GivenText:
    """One of them; `sha256` of its text in UTF-8, hexadecimal."""

    name: str
    sha256: str
    text: str
    given_by: str
    given_at: datetime.datetime
    removed: bool


@asked_apart
class GivenStore:
    """All of them, by kind and name. The database says which of two of a name was first."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def all(self, kind: GivenKind) -> dict[str, str]:
        """SHA-256 by name, of those that were not removed."""
        chosen = select(GivenRow.name, GivenRow.sha256).where(GivenRow.kind == kind)
        chosen = chosen.where(GivenRow.removed_at.is_(None)).order_by(GivenRow.name)
        with self._transaction() as session:
            return {row.name: row.sha256 for row in session.execute(chosen)}

    def get(self, kind: GivenKind, name: str) -> GivenText | None:
        """One of them, also if it was removed."""
        with self._transaction() as session:
            return _there(session, kind, name)

    def give(
        self, kind: GivenKind, name: str, text: str, by: str, *, instead_of: str = "", based_on: str = ""
    ) -> bool:
        """Keep a text; false if the name stands for another.

        Args:
            instead_of: SHA-256 of the text that may be replaced; '' for none. One that was removed may be.
            based_on: name of the one that it was made from; '' if it is new.
        """
        sha256 = hashlib.sha256(text.encode("utf-8")).hexdigest()
        row: dict[str, object] = {"kind": kind, "name": name, "sha256": sha256, "text": text}
        row |= {"given_by": shortened(by, 100), "given_at": now(), "removed_at": None}
        free = or_(GivenRow.removed_at.is_not(None), GivenRow.sha256 == instead_of)
        with self._transaction() as session:
            if put(session, GivenRow, row, where=free):
                if kind != "picture":  # stays what its name says, and is no text that is compared
                    add_version(session, row, based_on)
                return True
            there = _there(session, kind, name)
            return there is not None and not there.removed and there.sha256 == sha256

    def remove(self, kind: GivenKind, name: str) -> bool:
        """Have it removed; false if there is none. Its text stays in its row until the name is given anew."""
        there = GivenRow.kind == kind, GivenRow.name == name, GivenRow.removed_at.is_(None)
        removed = update(GivenRow).where(*there).values(removed_at=now()).returning(GivenRow.name)
        with self._transaction() as session:
            return session.execute(removed).first() is not None


def _there(session: Session, kind: GivenKind, name: str) -> GivenText | None:
    row = session.get(GivenRow, (kind, name))
    if row is None:
        return None
    given_at = aware(row.given_at)
    assert given_at is not None
    removed = row.removed_at is not None
    return GivenText(row.name, row.sha256, row.text, row.given_by, given_at, removed)
