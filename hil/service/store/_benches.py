"""Which service drives a bench, where several share a database, and who has a bench for oneself."""

from __future__ import annotations

import datetime

from sqlalchemy import Engine, and_, delete, exists, or_, select
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.api import LeaseData
from hil.core.errors.wording import shortened
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now_there
from hil.service.store._tables import BenchRow, LeaseRow, RunRow, put


@asked_apart
class LeaseStore:
    """Benches that somebody has for themselves until a moment that they put off again and again."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, bench: str) -> LeaseData | None:
        """Who has it now."""
        with self._transaction() as session:
            row = session.get(LeaseRow, bench)
            return None if row is None else _lease(row, now_there(session))

    def take(self, bench: str, holder: str, for_s: float) -> LeaseData | None:
        """Have a bench from now on for a while; None if somebody else has it."""
        with self._transaction() as session:
            moment = now_there(session)
            until = moment + datetime.timedelta(seconds=for_s)
            free = or_(LeaseRow.holder == holder, LeaseRow.until <= moment)
            row = {"bench": bench, "holder": holder, "until": until}
            taken = put(session, LeaseRow, row, where=free)
        return LeaseData(bench=bench, holder=holder, until=until) if taken else None

    def give_back(self, bench: str) -> None:
        """No one has it any more."""
        with self._transaction() as session:
            session.execute(delete(LeaseRow).where(LeaseRow.bench == bench))


def _lease(row: LeaseRow, moment: datetime.datetime) -> LeaseData | None:
    """None if it is over."""
    until = aware(row.until)
    assert until is not None
    return LeaseData(bench=row.bench, holder=row.holder, until=until) if until > moment else None


HELD_S = 60.0


@asked_apart
class BenchStore:
    """Benches that a service drives, each until a moment that it puts off again and again.

    A bench stays with its service beyond that moment while a run of it is under way, as far as is written:
    the run goes on without the database.

    An agent has its benches in the same way, as if it were a service.

    Args:
        service: which one, the same each time that it begins in its folder.
        place: where it is, in words.
    """

    def __init__(self, engine: Engine, service: str, place: str = "") -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin
        self.service, self.place = service, place

    def hold(self, bench: str, for_s: float = HELD_S) -> str:
        """Drive a bench, or go on with it; who drives it if that is somebody else."""
        with self._transaction() as session:
            moment = now_there(session)
            until = moment + datetime.timedelta(seconds=for_s)
            others = exists().where(
                RunRow.bench == bench,
                RunRow.state == "running",
                RunRow.service.not_in((self.service, "")),
            )
            free = or_(BenchRow.service == self.service, and_(BenchRow.until <= moment, ~others))
            row = {
                "bench": bench,
                "service": self.service,
                "place": shortened(self.place, 300),
                "until": until,
            }
            if put(session, BenchRow, row, where=free):
                return ""
            there = session.scalars(select(BenchRow).where(BenchRow.bench == bench)).one()
            end = aware(there.until)
            late = "" if end is None or end > moment else f", unheard of since {end:%Y-%m-%d %H:%M:%S} UTC"
            return f"{there.place or there.service}{late}"

    def give_back(self, bench: str | None = None) -> None:
        """Others may drive them, or one of them."""
        mine = delete(BenchRow).where(BenchRow.service == self.service)
        with self._transaction() as session:
            session.execute(mine if bench is None else mine.where(BenchRow.bench == bench))
