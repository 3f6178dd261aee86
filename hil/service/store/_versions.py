"""Versions of what people gave: every text, with who gave it and when, also after it was replaced or removed.

A plan is replaced under its name. A model, a controller or a bench file stays what its name says: what is
made of one has a name of its own. Both are versions of one family, numbered in their order.
Pictures have none.
"""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Engine, delete, func, select
from sqlalchemy.orm import Session, sessionmaker

from hil.api_schemas.upload import VersionedKind
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware
from hil.service.store._tables import VersionRow

#: Of a family; older ones go.
_MOST_KEPT = 200


@dataclass(frozen=True)
class GivenVersion:
    """One of a family; `sha256` of its text, hexadecimal."""

    number: int
    name: str
    sha256: str
    given_by: str
    given_at: datetime.datetime


@asked_apart
class VersionStore:
    """All versions, by kind, family and number."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, kind: VersionedKind, name: str) -> list[GivenVersion]:
        """Those of the family that a name belongs to, newest first; a family has the name of its first."""
        columns = (VersionRow.number, VersionRow.name, VersionRow.sha256)
        with self._transaction() as session:
            family = _family_of(session, kind, name) or name
            chosen = select(*columns, VersionRow.given_by, VersionRow.given_at).where(
                VersionRow.kind == kind, VersionRow.family == family
            )
            rows = session.execute(chosen.order_by(VersionRow.number.desc())).all()
            return [_version(row.number, row.name, row.sha256, row.given_by, row.given_at) for row in rows]

    def text(self, kind: VersionedKind, name: str, number: int) -> str | None:
        """The text of a version of the family that a name belongs to; None if there is none."""
        with self._transaction() as session:
            family = _family_of(session, kind, name) or name
            row = session.get(VersionRow, (kind, family, number))
            return None if row is None else row.text


def add_version(session: Session, row: dict[str, Any], based_on: str) -> None:
    """Keep what was just given under a name: in the name's family, else in that of what it was made from."""
    kind, name = row["kind"], row["name"]
    family = _family_of(session, kind, name)
    if family is None:
        family = (_family_of(session, kind, based_on) or based_on) if based_on else name
    mine = VersionRow.kind == kind, VersionRow.family == family
    last = session.scalar(select(func.max(VersionRow.number)).where(*mine)) or 0
    there = session.get(VersionRow, (kind, family, last))
    if there is not None and (there.name, there.sha256) == (name, row["sha256"]):
        return
    kept = {key: row[key] for key in ("kind", "name", "sha256", "text", "given_by", "given_at")}
    session.add(VersionRow(family=family, number=last + 1, **kept))
    session.execute(delete(VersionRow).where(*mine, VersionRow.number <= last + 1 - _MOST_KEPT))


def _family_of(session: Session, kind: str, name: str) -> str | None:
    chosen = select(VersionRow.family).where(VersionRow.kind == kind, VersionRow.name == name)
    return session.scalar(chosen.order_by(VersionRow.given_at.desc()).limit(1))


def _version(number: int, name: str, sha256: str, by: str, at: datetime.datetime) -> GivenVersion:
    given_at = aware(at)
    assert given_at is not None
    return GivenVersion(number, name, sha256, by, given_at)
