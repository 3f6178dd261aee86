"""Notes of a shift for the next."""

from __future__ import annotations

from sqlalchemy import Engine, select
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.team import HandoverData, HandoverWanted
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now
from hil.service.store._team_tables import HandoverRow


@asked_apart
class HandoverStore:
    """Notes are added and stay: who reads one later reads what was written then."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def of(self, bench: str, before: int, most: int) -> list[HandoverData]:
        """Notes of a bench, newest first."""
        chosen = select(HandoverRow).where(HandoverRow.bench == bench, HandoverRow.id < before)
        with self._transaction() as session:
            found = session.scalars(chosen.order_by(HandoverRow.id.desc()).limit(most))
            return [_data(row) for row in found]

    def add(self, bench: str, who: str, wanted: HandoverWanted) -> HandoverData:
        """Add a note."""
        row = HandoverRow(
            bench=bench, day=wanted.day, shift=wanted.shift, text=wanted.text, who=who, at=now()
        )
        with self._transaction() as session:
            session.add(row)
            session.flush()
            return _data(row)


def _data(row: HandoverRow) -> HandoverData:
    return HandoverData.model_validate(
        {
            "id": row.id,
            "bench": row.bench,
            "day": row.day,
            "shift": row.shift,
            "text": row.text,
            "who": row.who,
            "at": aware(row.at),
        }
    )
