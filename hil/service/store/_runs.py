"""Runs as they are kept: queued, taken once, ended once."""

from __future__ import annotations

import datetime
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import ColumnElement, Engine, func, or_, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session, sessionmaker

from hil.api_schemas.agent import TakenRun
from hil.api_schemas.api import RunData, RunState, TrendPoint
from hil.core.errors.wording import shortened
from hil.core.result import CriterionResult, RunResult
from hil.service.store._benches import HELD_S
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now, now_there
from hil.service.store._tables import BenchRow, CriterionRow, RunRow

_SAME = (
    "id", "plan", "title", "bench", "state", "priority", "hazard", "requested_by", "approved_by",
    "exit_code", "verdict", "safe_state", "reason", "dut",
)  # fmt: skip
_MOMENTS = ("queued_at", "started_at", "ended_at")
#: Columns that `run_data` reads.
RUN_COLUMNS = frozenset({*_SAME, *_MOMENTS, "values_json"})
_WAITING: tuple[RunState, ...] = ("waiting_approval", "queued")
_LONGEST_KEY = 100


@dataclass(frozen=True)
class NewRun:
    """A run to be queued; `plan_text` has its variables as chosen, `key` is one of the person's own."""

    plan: str
    title: str
    plan_text: str
    plan_source: str
    bench: str
    values: Mapping[str, float]
    requested_by: str
    priority: int = 0
    hazard: str = ""
    confirmed_by: str = ""
    accept_expired: str = ""
    key: str = ""


@asked_apart
class RunStore:
    """Every call is one transaction; what has returned survives a kill and a power cut."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def add(self, wanted: NewRun, *, approved: bool) -> tuple[RunData, bool]:
        """Queue a run, unless theirs of the same key is there; the run, and whether it is a new one."""
        own_key = _own_key(wanted.requested_by, wanted.key) if wanted.key else None
        row = RunRow(
            key=own_key,
            plan=wanted.plan,
            title=shortened(wanted.title, 200),
            plan_text=wanted.plan_text,
            plan_source=wanted.plan_source,
            service="",
            bench=wanted.bench,
            state="queued" if approved else "waiting_approval",
            values_json=json.dumps(dict(wanted.values)),
            priority=wanted.priority,
            hazard=shortened(wanted.hazard, 500),
            confirmed_by=wanted.confirmed_by,
            accept_expired=wanted.accept_expired,
            requested_by=wanted.requested_by,
            approved_by="",
            queued_at=now(),
            reason="",
        )
        try:
            with self._transaction() as session:
                session.add(row)
                session.flush()
                return run_data(row), True
        except IntegrityError:
            with self._transaction() as session:
                return run_data(session.scalars(select(RunRow).where(RunRow.key == own_key)).one()), False

    def get(self, run: int) -> RunData | None:
        """A run by its number."""
        with self._transaction() as session:
            row = session.get(RunRow, run)
            return None if row is None else run_data(row)

    def all(
        self,
        *,
        bench: str | None,
        states: Sequence[RunState],
        before: int,
        most: int,
        verdicts: Sequence[str] = (),
        steps: Sequence[str] = (),
    ) -> list[RunData]:
        """Runs, newest first; of given states and verdicts, and of plans with one of some kinds of steps."""
        chosen = select(RunRow).order_by(RunRow.id.desc()).limit(most).where(RunRow.id < before)
        if bench is not None:
            chosen = chosen.where(RunRow.bench == bench)
        if states:
            chosen = chosen.where(RunRow.state.in_(states))
        if verdicts:
            chosen = chosen.where(RunRow.verdict.in_(verdicts))
        if steps:  # a step begins with its kind; a plan that only mentions it is found, too
            chosen = chosen.where(or_(*(RunRow.plan_text.contains(f"{kind}:") for kind in steps)))
        with self._transaction() as session:
            return [run_data(row) for row in session.scalars(chosen)]

    def waiting(self, bench: str) -> int:
        """How many wait for a bench."""
        with self._transaction() as session:
            of_bench = RunRow.bench == bench, RunRow.state.in_(_WAITING)
            return session.scalar(select(func.count()).select_from(RunRow).where(*of_bench)) or 0

    def counts(self) -> dict[tuple[str, str], int]:
        """Number of runs by bench and state."""
        chosen = select(RunRow.bench, RunRow.state, func.count()).group_by(RunRow.bench, RunRow.state)
        with self._transaction() as session:
            return {(bench, state): count for bench, state, count in session.execute(chosen)}

    def queued(self, bench: str, most: int) -> list[RunData]:
        """Runs that may start on a bench, the next first."""
        chosen = select(RunRow).where(RunRow.bench == bench, RunRow.state == "queued")
        chosen = chosen.order_by(RunRow.priority.desc(), RunRow.id).limit(most)
        with self._transaction() as session:
            return [run_data(row) for row in session.scalars(chosen)]

    def take(self, run: int, service: str) -> TakenRun | None:
        """Mark a queued run as running, before anything of it is started.

        None if it is not queued any more, or its bench is not this service's any more (`BenchStore.hold`).
        """
        with self._transaction() as session:
            of_run = select(RunRow.bench).where(RunRow.id == run).scalar_subquery()
            ours = update(BenchRow).where(BenchRow.bench == of_run, BenchRow.service == service)
            until = now_there(session) + datetime.timedelta(seconds=HELD_S)
            if not session.execute(ours.values(until=until).returning(BenchRow.bench)).all():
                return None
            changes = {"state": "running", "started_at": now(), "service": service}
            if not _moved(session, run, ("queued",), **changes):
                return None
            row = session.get_one(RunRow, run)
            return _taken(row)

    def taken(self, run: int) -> TakenRun | None:
        """A run that is written down as running, once more."""
        with self._transaction() as session:
            row = session.get(RunRow, run)
            return _taken(row) if row is not None and row.state == "running" else None

    def running(self, service: str) -> list[RunData]:
        """Runs that a service has started and that have not ended, as far as is written."""
        mine = RunRow.state == "running", RunRow.service.in_((service, ""))
        with self._transaction() as session:
            return [run_data(row) for row in session.scalars(select(RunRow).where(*mine))]

    def of_service(self, run: int, service: str) -> RunData | None:
        """A run, if that service, or agent, has started it and no one else has its files."""
        with self._transaction() as session:
            row = session.get(RunRow, run)
            return run_data(row) if row is not None and row.service == service else None

    def delivered(
        self,
        run: int,
        agent: str,
        service: str,
        state: RunState,
        *,
        exit_code: int | None,
        result: RunResult | None,
        reason: str,
        dut: str,
        ago_s: float,
    ) -> bool:
        """Write how an agent's run ended whose files the service has now; false if it is not the agent's.

        Also of one that was given up meanwhile: what really happened takes the place of that.
        """
        ended_at = now() - datetime.timedelta(seconds=ago_s)
        with self._transaction() as session:
            row = session.get(RunRow, run)
            if row is None or row.service != agent or row.state not in ("running", "interrupted"):
                return False
            changes = _ending(state, exit_code, result, reason)
            changes |= {"ended_at": ended_at, "service": service}
            return _ended(session, run, ("running", "interrupted"), changes, result, dut)

    def end(
        self,
        run: int,
        state: RunState,
        *,
        exit_code: int | None = None,
        result: RunResult | None = None,
        reason: str = "",
        dut: str = "",
        at: datetime.datetime | None = None,
    ) -> bool:
        """Write how a running run ended, with its criteria; false if that was written before.

        Args:
            at: when it ended, if that is known and was not just now.
        """
        with self._transaction() as session:
            changes = _ending(state, exit_code, result, reason)
            if at is not None:
                changes["ended_at"] = min(at, now())
            return _ended(session, run, ("running",), changes, result, dut)

    def criteria(
        self, bench: str, plan: str, dut: str | None, most: int, like: int | None = None
    ) -> list[tuple[str, TrendPoint]]:
        """Criteria of a plan's newest runs that ended on a bench, by name, oldest first.

        Only runs of the very same text as the newest, or as the run `like`: with other values of its
        variables, or after a change of the plan, figures are not those of one and the same test. Nor are
        those of a run cut short.
        """
        ended = RunRow.bench == bench, RunRow.plan == plan, RunRow.state == "ended", RunRow.verdict != "error"
        those = ended if like is None else (*ended, RunRow.id == like)
        text = select(RunRow.plan_text).where(*those).order_by(RunRow.id.desc()).limit(1).scalar_subquery()
        newest = select(RunRow.id).where(*ended, RunRow.plan_text == text)
        newest = newest.order_by(RunRow.id.desc()).limit(most)
        chosen = select(CriterionRow, RunRow.ended_at).join(RunRow, RunRow.id == CriterionRow.run)
        chosen = chosen.where(CriterionRow.run.in_(newest)).order_by(CriterionRow.run, CriterionRow.id)
        if dut is not None:
            chosen = chosen.where(CriterionRow.dut == dut)
        with self._transaction() as session:
            return [(row.id, _point(row, ended_at)) for row, ended_at in session.execute(chosen)]

    def put_back(self, run: int) -> bool:
        """Queue a run again of which nothing has happened: its bench was taken by somebody quicker."""
        with self._transaction() as session:
            return _moved(session, run, ("running",), state="queued", started_at=None, service="")

    def cancel(self, run: int, reason: str) -> bool:
        """End a run that waits; false if it does not wait."""
        with self._transaction() as session:
            return _moved(session, run, _WAITING, state="cancelled", ended_at=now(), reason=reason)

    def approve(self, run: int, by: str) -> bool:
        """Let a run that waits for approval be queued; false if it does not wait for it."""
        with self._transaction() as session:
            return _moved(session, run, ("waiting_approval",), state="queued", approved_by=by)

    def set_priority(self, run: int, priority: int) -> bool:
        """Change the priority of a run that waits; false if it does not wait."""
        with self._transaction() as session:
            return _moved(session, run, _WAITING, priority=priority)


def _moved(session: Session, run: int, out_of: Sequence[RunState], **changes: object) -> bool:
    """Change a run if it still is in one of these states: of two who try, one does."""
    where: tuple[ColumnElement[bool], ...] = (RunRow.id == run, RunRow.state.in_(out_of))
    changed = session.execute(update(RunRow).where(*where).values(**changes).returning(RunRow.id))
    return len(changed.all()) == 1


def _own_key(person: str, key: str) -> str:
    """A person's key among those of all; a long one by its SHA-256, for two keys are never the same."""
    own = f"{person}:{key}"
    return own if len(own) <= _LONGEST_KEY else hashlib.sha256(own.encode()).hexdigest()


def _ending(
    state: RunState, exit_code: int | None, result: RunResult | None, reason: str
) -> dict[str, object]:
    changes: dict[str, object] = {"state": state, "ended_at": now(), "exit_code": exit_code}
    why = reason or (result.reason if result else "")
    changes["reason"] = why.replace("\0", " ")  # PostgreSQL keeps no text with it
    if result is not None:
        changes |= {"verdict": result.verdict, "safe_state": result.safe_state}
    return changes


def _ended(
    session: Session,
    run: int,
    out_of: Sequence[RunState],
    changes: dict[str, object],
    result: RunResult | None,
    dut: str,
) -> bool:
    if not _moved(session, run, out_of, **changes, dut=shortened(dut, 200)):
        return False
    session.add_all(_criterion(run, one, dut) for one in (result.criteria if result else ()))
    return True


def _criterion(run: int, one: CriterionResult, dut: str) -> CriterionRow:
    return CriterionRow(
        run=run,
        id=shortened(one.id, 200),
        value=one.value,
        unit=shortened(one.unit, 40),
        upper=one.upper,
        lower=one.lower,
        verdict=one.verdict,
        dut=shortened(dut, 200),
    )


def _point(row: CriterionRow, ended_at: datetime.datetime | None) -> TrendPoint:
    moment = aware(ended_at)
    assert moment is not None, "the run has ended"
    return TrendPoint(
        run=row.run,
        ended_at=moment,
        dut=row.dut,
        value=row.value,
        unit=row.unit,
        upper=row.upper,
        lower=row.lower,
        verdict=row.verdict,
    )


def _taken(row: RunRow) -> TakenRun:
    return TakenRun(
        data=run_data(row),
        plan_text=row.plan_text,
        plan_source=row.plan_source,
        confirmed_by=row.confirmed_by,
        accept_expired=row.accept_expired,
    )


def run_data(row: RunRow) -> RunData:
    """A run as the API has it."""
    moments: dict[str, datetime.datetime | None] = {name: aware(getattr(row, name)) for name in _MOMENTS}
    return RunData.model_validate(
        {
            **{name: getattr(row, name) for name in _SAME},
            **moments,
            "values": json.loads(row.values_json),
        }
    )
