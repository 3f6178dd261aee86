"""Reservations of benches: from a moment to another, never two of different people at once."""

from __future__ import annotations

import zlib

from sqlalchemy import Engine, delete, func, select, text
from sqlalchemy.orm import Session, sessionmaker

from hil.api_schemas.api import ReservationData
from hil.api_schemas.team import MOST_RESERVATIONS, ReservationWanted
from hil.core.errors import BadInputError
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now_there
from hil.service.store._team_tables import AdmittedRunRow, ReservationRow

_RESERVING = 0x72657376  # of two who reserve a bench at once, one waits


@asked_apart
class ReservationStore:
    """By the database's clock; what is over stays there, for the record."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, bench: str) -> list[ReservationData]:
        """Those of a bench that are not over, the next first."""
        with self._transaction() as session:
            open_ones = ReservationRow.bench == bench, ReservationRow.ends > now_there(session)
            rows = list(
                session.scalars(select(ReservationRow).where(*open_ones).order_by(ReservationRow.begins))
            )
            if not rows:
                return []
            of_these = AdmittedRunRow.reservation.in_([row.id for row in rows])
            admitted: dict[int, list[int]] = {}
            for one in session.scalars(select(AdmittedRunRow).where(of_these).order_by(AdmittedRunRow.run)):
                admitted.setdefault(one.reservation, []).append(one.run)
            return [_data(row, admitted.get(row.id, [])) for row in rows]

    def add(self, bench: str, who: str, wanted: ReservationWanted) -> tuple[ReservationData, bool]:
        """Reserve a bench; the reservation and true, or that of somebody which it would meet and false.

        Raises:
            BadInputError: it would be over already, or there are too many.
        """
        with self._transaction() as session:
            _alone(session, bench)
            moment = now_there(session)
            if wanted.ends <= moment:
                raise BadInputError("the reservation would be over", where="ends", fix="give a later end")
            meeting = select(ReservationRow).where(
                ReservationRow.bench == bench,
                ReservationRow.begins < wanted.ends,
                ReservationRow.ends > wanted.begins,
            )
            there = session.scalars(meeting.order_by(ReservationRow.begins).limit(1)).first()
            if there is not None:
                return _data(there, []), False
            count = select(func.count()).select_from(ReservationRow)
            count = count.where(ReservationRow.bench == bench, ReservationRow.ends > moment)
            if (session.scalar(count) or 0) >= MOST_RESERVATIONS:
                raise BadInputError(f"has {MOST_RESERVATIONS} reservations", where=bench, fix="remove one")
            row = ReservationRow(
                bench=bench, who=who, begins=wanted.begins, ends=wanted.ends, reason=wanted.reason
            )
            session.add(row)
            session.flush()
            return _data(row, []), True

    def get(self, bench: str, reservation: int) -> ReservationData | None:
        """None if the bench has no such reservation."""
        with self._transaction() as session:
            row = session.get(ReservationRow, reservation)
            return _data(row, []) if row is not None and row.bench == bench else None

    def remove(self, reservation: int) -> None:
        """Remove a reservation."""
        with self._transaction() as session:
            session.execute(delete(AdmittedRunRow).where(AdmittedRunRow.reservation == reservation))
            session.execute(delete(ReservationRow).where(ReservationRow.id == reservation))

    def admit(self, reservation: int, run: int) -> None:
        """Let a run of somebody else start meanwhile."""
        with self._transaction() as session:
            session.merge(AdmittedRunRow(reservation=reservation, run=run))


def _alone(session: Session, bench: str) -> None:
    if session.get_bind().dialect.name == "postgresql":
        keys = {"kind": _RESERVING, "bench": zlib.crc32(bench.encode()) - 2**31}
        session.execute(text("SELECT pg_advisory_xact_lock(:kind, :bench)"), keys)


def _data(row: ReservationRow, admitted: list[int]) -> ReservationData:
    begins, ends = aware(row.begins), aware(row.ends)
    assert begins is not None
    assert ends is not None
    return ReservationData(
        id=row.id,
        bench=row.bench,
        who=row.who,
        begins=begins,
        ends=ends,
        reason=row.reason,
        admitted=admitted,
    )
