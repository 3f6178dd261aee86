"""Benches that somebody has for themselves."""

from __future__ import annotations

import datetime

from sqlalchemy import Engine, delete
from sqlalchemy.orm import sessionmaker

from hil.service.data import LeaseData
from hil.service.store._opening import aware, now
from hil.service.store._tables import LeaseRow


class LeaseStore:
    """Benches that somebody has for themselves until a moment that they put off again and again."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, bench: str) -> LeaseData | None:
        """Who has it now."""
        with self._transaction() as session:
            row = session.get(LeaseRow, bench)
            return None if row is None else _lease(row)

    def take(self, bench: str, holder: str, for_s: float) -> LeaseData | None:
        """Have a bench from now on for a while; None if somebody else has it."""
        until = now() + datetime.timedelta(seconds=for_s)
        with self._transaction() as session:
            row = session.get(LeaseRow, bench)
            there = None if row is None else _lease(row)
            if there is not None and there.holder != holder:
                return None
            session.merge(LeaseRow(bench=bench, holder=holder, until=until))
        return LeaseData(bench=bench, holder=holder, until=until)

    def give_back(self, bench: str) -> None:
        """Nobody has it any more."""
        with self._transaction() as session:
            session.execute(delete(LeaseRow).where(LeaseRow.bench == bench))


def _lease(row: LeaseRow) -> LeaseData | None:
    """None if it is over."""
    until = aware(row.until)
    assert until is not None
    return LeaseData(bench=row.bench, holder=row.holder, until=until) if until > now() else None
