"""Files of runs that the archive has, and runs whose files it is still to be given."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import ColumnElement, Engine, func, select, update
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.api import OVER
from hil.service.store._books import asked_apart
from hil.service.store._opening import now
from hil.service.store._tables import FileRow, RunRow


@dataclass(frozen=True)
class KeptFile:
    """A file of a run, confirmed in the archive; `sha256` hexadecimal."""

    name: str
    size: int
    sha256: str


@asked_apart
class FileStore:
    """What was confirmed in the archive, and of which runs all was."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, run: int) -> list[KeptFile]:
        """Files of a run that the archive has."""
        chosen = select(FileRow).where(FileRow.run == run).order_by(FileRow.name)
        with self._transaction() as session:
            return [KeptFile(row.name, row.size, row.sha256) for row in session.scalars(chosen)]

    def add(self, run: int, file: KeptFile) -> None:
        """The archive has a file, as was confirmed."""
        row = FileRow(run=run, name=file.name, size=file.size, sha256=file.sha256)
        with self._transaction() as session:
            session.merge(row)

    def all_kept(self, run: int) -> None:
        """The archive has all files of a run."""
        with self._transaction() as session:
            session.execute(update(RunRow).where(RunRow.id == run).values(kept_at=now()))

    def to_keep(self, service: str) -> list[int]:
        """Runs of a service that are over and whose files are not all kept, oldest first."""
        with self._transaction() as session:
            return list(session.scalars(select(RunRow.id).where(*_waiting(service)).order_by(RunRow.id)))

    def waiting(self, service: str) -> int:
        """How many those are."""
        with self._transaction() as session:
            return session.scalar(select(func.count()).select_from(RunRow).where(*_waiting(service))) or 0

    def kept(self, runs: list[int]) -> list[int]:
        """Those of some runs of which the archive has all files."""
        with self._transaction() as session:
            chosen = select(RunRow.id).where(RunRow.id.in_(runs), RunRow.kept_at.is_not(None))
            return list(session.scalars(chosen))


def _waiting(service: str) -> tuple[ColumnElement[bool], ...]:
    started = RunRow.state.in_(OVER), RunRow.started_at.is_not(None)
    return (*started, RunRow.kept_at.is_(None), RunRow.service.in_((service, "")))
