"""How long runs took: what a run of the same plan can be expected to take."""

from __future__ import annotations

import statistics

from sqlalchemy import Engine, select
from sqlalchemy.orm import aliased, sessionmaker

from hil.service.store._books import asked_apart
from hil.service.store._opening import aware
from hil.service.store._tables import RunRow

_NEWEST = 5


@asked_apart
class DurationStore:
    """Seconds from the start of runs to their end."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def measured_s(self, run: int) -> float | None:
        """Median of the newest runs to the end of the very same plan on the same bench; None if none was."""
        wanted = aliased(RunRow)
        chosen = select(RunRow.started_at, RunRow.ended_at).join(wanted, wanted.id == run)
        chosen = chosen.where(
            RunRow.bench == wanted.bench,
            RunRow.state == "ended",
            RunRow.plan == wanted.plan,
            RunRow.plan_text == wanted.plan_text,
            RunRow.verdict.in_(("pass", "fail", "done")),
        )
        with self._transaction() as session:
            found = session.execute(chosen.order_by(RunRow.id.desc()).limit(_NEWEST)).all()
        seconds = [
            (ended - started).total_seconds()
            for started, ended in ((aware(one), aware(other)) for one, other in found)
            if started is not None and ended is not None
        ]
        return statistics.median(seconds) if seconds else None
