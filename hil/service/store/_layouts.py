"""Plots that people have chosen, by person and plan."""

from __future__ import annotations

from sqlalchemy import Engine, delete, select, true
from sqlalchemy.orm import sessionmaker

from hil.service.store._books import asked_apart
from hil.service.store._opening import now
from hil.service.store._tables import LayoutRow, put

#: Of one person; the oldest give way.
MOST_OF_ONE = 200


@asked_apart
class LayoutStore:
    """What the page shows first of runs of a plan; the page alone knows what the texts mean."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, person: str, plan: str) -> str:
        """'' if none was kept."""
        with self._transaction() as session:
            row = session.get(LayoutRow, (person, plan))
            return row.text if row is not None else ""

    def keep(self, person: str, plan: str, text: str) -> None:
        """In the place of what was there."""
        with self._transaction() as session:
            row = {"person": person, "plan": plan, "text": text, "kept_at": now()}
            put(session, LayoutRow, row, where=true())
            newest = select(LayoutRow.plan).where(LayoutRow.person == person)
            newest = newest.order_by(LayoutRow.kept_at.desc(), LayoutRow.plan).limit(MOST_OF_ONE)
            others = LayoutRow.plan.not_in(newest)
            session.execute(delete(LayoutRow).where(LayoutRow.person == person, others))

    def forget(self, person: str, plan: str) -> None:
        """The usual plots come again."""
        with self._transaction() as session:
            session.execute(delete(LayoutRow).where(LayoutRow.person == person, LayoutRow.plan == plan))
