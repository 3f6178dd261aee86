"""Benches that somebody has for themselves."""

from __future__ import annotations

import datetime

from sqlalchemy import Engine, delete, or_
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.api import LeaseData
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now_there
from hil.service.store._tables import LeaseRow
from hil.service.store._upsert import put


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
