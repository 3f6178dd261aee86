"""Studies, campaigns and given recordings of all services, and files of them that the archive has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from sqlalchemy import Engine, case, delete, select, update
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import sessionmaker

from hil.core.errors.wording import shortened
from hil.service.store._books import asked_apart
from hil.service.store._files import KeptFile
from hil.service.store._opening import now
from hil.service.store._tables import NumberRow, ResultFileRow, ResultRow, put

ResultKind = Literal["study", "campaign", "recording"]


@dataclass(frozen=True)
class SharedJob:
    """What a service tells of one: `facts` as JSON, and where that service is, in words."""

    id: int
    facts: str
    place: str


@asked_apart
class ResultStore:
    """All of them, by kind and number. One is its service's, which alone may change or remove it.

    Args:
        service: which one, the same each time that it begins in its folder.
        place: where it is, in words.
    """

    def __init__(self, engine: Engine, service: str, place: str) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin
        self._service, self._place = service, place

    def draw(self, kind: ResultKind, above: int) -> int:
        """A number above that one which no service has been given before."""
        with self._transaction() as session:
            to_sql = postgresql if session.get_bind().dialect.name == "postgresql" else sqlite
            first = to_sql.insert(NumberRow).values(kind=kind, last=above + 1)
            later = case((NumberRow.last > above, NumberRow.last + 1), else_=above + 1)
            drawn = first.on_conflict_do_update(index_elements=["kind"], set_={"last": later})
            return int(session.execute(drawn.returning(NumberRow.last)).scalar_one())

    def tell(self, kind: ResultKind, number: int, facts: str) -> bool:
        """Have one known to others, new or changed; false if the number is that of another service's."""
        row: dict[str, Any] = {"kind": kind, "id": number, "service": self._service, "facts": facts}
        row |= {"place": shortened(self._place, 300), "kept_at": None}
        with self._transaction() as session:
            return put(session, ResultRow, row, where=ResultRow.service == self._service)

    def mine(self, kind: ResultKind) -> dict[int, str]:
        """Facts by number of those that this service has published."""
        chosen = select(ResultRow).where(ResultRow.kind == kind, ResultRow.service == self._service)
        with self._transaction() as session:
            return {row.id: row.facts for row in session.scalars(chosen)}

    def not_kept(self, kind: ResultKind) -> list[int]:
        """Those of this service whose files the archive has not all, oldest first."""
        chosen = select(ResultRow.id).where(ResultRow.kind == kind, ResultRow.service == self._service)
        with self._transaction() as session:
            return list(session.scalars(chosen.where(ResultRow.kept_at.is_(None)).order_by(ResultRow.id)))

    def all_kept(self, kind: ResultKind, number: int, facts: str) -> None:
        """The archive has all files of one as it is published with these facts."""
        same = ResultRow.kind == kind, ResultRow.id == number, ResultRow.facts == facts
        with self._transaction() as session:
            session.execute(update(ResultRow).where(*same).values(kept_at=now()))

    def others(self, kind: ResultKind) -> list[SharedJob]:
        """Those of other services, newest first."""
        chosen = select(ResultRow).where(ResultRow.kind == kind, ResultRow.service != self._service)
        with self._transaction() as session:
            return [_shared_job(row) for row in session.scalars(chosen.order_by(ResultRow.id.desc()))]

    def other(self, kind: ResultKind, number: int) -> SharedJob | None:
        """One of another service; None if there is none."""
        with self._transaction() as session:
            row = session.get(ResultRow, (kind, number))
            return None if row is None or row.service == self._service else _shared_job(row)

    def names(self, kind: ResultKind) -> dict[int, list[str]]:
        """Names of all files that the archive has, by number."""
        chosen = select(ResultFileRow).where(ResultFileRow.kind == kind).order_by(ResultFileRow.name)
        found: dict[int, list[str]] = {}
        with self._transaction() as session:
            for row in session.scalars(chosen):
                found.setdefault(row.id, []).append(row.name)
        return found

    def files(self, kind: ResultKind, number: int) -> list[KeptFile]:
        """Files of one that the archive has."""
        of_it = ResultFileRow.kind == kind, ResultFileRow.id == number
        with self._transaction() as session:
            found = session.scalars(select(ResultFileRow).where(*of_it).order_by(ResultFileRow.name))
            return [KeptFile(row.name, row.size, row.sha256) for row in found]

    def add_file(self, kind: ResultKind, number: int, file: KeptFile) -> None:
        """The archive has a file, as was confirmed."""
        row = ResultFileRow(kind=kind, id=number, name=file.name, size=file.size, sha256=file.sha256)
        with self._transaction() as session:
            session.merge(row)

    def forget_file(self, kind: ResultKind, number: int, name: str) -> None:
        """The archive has a file no more."""
        of_it = ResultFileRow.kind == kind, ResultFileRow.id == number, ResultFileRow.name == name
        with self._transaction() as session:
            session.execute(delete(ResultFileRow).where(*of_it))

    def remove(self, kind: ResultKind, number: int) -> None:
        """There is no such one of this service any more."""
        there = ResultRow.kind == kind, ResultRow.id == number, ResultRow.service == self._service
        with self._transaction() as session:
            session.execute(delete(ResultRow).where(*there))


def _shared_job(row: ResultRow) -> SharedJob:
    return SharedJob(row.id, row.facts, row.place)
