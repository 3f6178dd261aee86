"""Notes and tags of runs."""

from __future__ import annotations

from sqlalchemy import Engine, delete, func, select, true
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.notes import MOST_NOTES, MOST_TAGS, NoteData, RunNotes
from hil.core.errors import BadInputError
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now
from hil.service.store._tables import NoteRow, TagRow, put


@asked_apart
class NoteStore:
    """Every call is one transaction. What is removed is gone; the audit log tells of it."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, run: int) -> RunNotes:
        """Tags in order of their letters, notes oldest first."""
        notes = select(NoteRow).where(NoteRow.run == run).order_by(NoteRow.id)
        tags = select(TagRow.tag).where(TagRow.run == run).order_by(TagRow.tag)
        with self._transaction() as session:
            return RunNotes(
                tags=list(session.scalars(tags)), notes=[_data(row) for row in session.scalars(notes)]
            )

    def add(self, run: int, who: str, text: str) -> NoteData:
        """Add a note.

        Raises:
            BadInputError: the run has too many.
        """
        count = select(func.count()).select_from(NoteRow).where(NoteRow.run == run)
        with self._transaction() as session:
            if (session.scalar(count) or 0) >= MOST_NOTES:
                raise BadInputError(f"has {MOST_NOTES} notes", where=f"run {run}", fix="remove one")
            row = NoteRow(run=run, at=now(), who=who, text=text)
            session.add(row)
            session.flush()
            return _data(row)

    def get(self, run: int, note: int) -> NoteData | None:
        """None if the run has no such note."""
        with self._transaction() as session:
            row = session.get(NoteRow, note)
            return _data(row) if row is not None and row.run == run else None

    def remove(self, note: int) -> None:
        """Remove a note."""
        with self._transaction() as session:
            session.execute(delete(NoteRow).where(NoteRow.id == note))

    def tag(self, run: int, tag: str, who: str) -> None:
        """Have a run found by a tag.

        Raises:
            BadInputError: the run has too many.
        """
        others = select(func.count()).select_from(TagRow).where(TagRow.run == run, TagRow.tag != tag)
        with self._transaction() as session:
            if (session.scalar(others) or 0) >= MOST_TAGS:
                raise BadInputError(f"has {MOST_TAGS} tags", where=f"run {run}", fix="take one off")
            put(session, TagRow, {"run": run, "tag": tag, "who": who, "at": now()}, where=true())

    def untag(self, run: int, tag: str) -> bool:
        """Whether the run had it."""
        with self._transaction() as session:
            chosen = delete(TagRow).where(TagRow.run == run, TagRow.tag == tag).returning(TagRow.run)
            return session.execute(chosen).first() is not None


def _data(row: NoteRow) -> NoteData:
    at = aware(row.at)
    assert at is not None
    return NoteData(id=row.id, at=at, who=row.who, text=row.text)
