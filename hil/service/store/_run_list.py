"""The list of all runs: filtered, sorted and paged by the database."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from sqlalchemy import ColumnElement, Engine, UnaryExpression, and_, func, or_, select
from sqlalchemy.orm import InstrumentedAttribute, load_only, sessionmaker

from hil.api_schemas.run_list import FoundRun, FoundRuns, RunChoices, RunsWanted
from hil.service.store._books import asked_apart
from hil.service.store._runs import RUN_COLUMNS, run_data
from hil.service.store._tables import CriterionRow, NoteRow, RunRow, TagRow

#: Criteria are offered of so many newest runs: going through those of all runs would take a second.
_NEWEST = 200
_MOST_CHOICES = 1000
#: The best is looked for among so many newest that passed: of 2,000 the service was busy for 0.3 s.
_MOST_PASSED = 200
_JUDGED = (
    CriterionRow.id,
    CriterionRow.value,
    CriterionRow.unit,
    CriterionRow.upper,
    CriterionRow.lower,
    CriterionRow.verdict,
)
_FILTERS: dict[str, InstrumentedAttribute[Any]] = {
    "bench": RunRow.bench,
    "plan": RunRow.plan,
    "dut": RunRow.dut,
    "state": RunRow.state,
    "verdict": RunRow.verdict,
    "requested_by": RunRow.requested_by,
}
_SEARCHED = (RunRow.plan, RunRow.title, RunRow.dut, RunRow.requested_by, RunRow.reason)
#: Columns of a run as the API has it: not the plan's text.
_SHOWN = [column for column in vars(RunRow).values() if getattr(column, "key", "") in RUN_COLUMNS]
_MOMENT = func.coalesce(RunRow.ended_at, RunRow.queued_at)
_ORDERS: dict[str, ColumnElement[Any]] = {
    "plan": RunRow.plan.expression,
    "bench": RunRow.bench.expression,
    "dut": RunRow.dut.expression,
    "verdict": RunRow.verdict.expression,
    "ended": RunRow.ended_at.expression,
    "value": CriterionRow.value.expression,
}


@asked_apart
class RunList:
    """Reads only; every call is one transaction."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin
        self._orders = {**_ORDERS, "duration": _took(engine.dialect.name)}

    def find(self, wanted: RunsWanted) -> FoundRuns:
        """A page of the runs that pass every filter, and how many do."""
        where = _conditions(wanted)
        page, count = select(RunRow.id), select(func.count()).select_from(RunRow)
        if wanted.criterion:
            page, count = page.join(CriterionRow, _is(wanted)), count.join(CriterionRow, _is(wanted))
        page = (
            page.where(*where).order_by(*_order(wanted, self._orders)).offset(wanted.first).limit(wanted.most)
        )
        with self._transaction() as session:
            numbers = list(session.scalars(page))
            listed = select(RunRow).where(RunRow.id.in_(numbers)).options(load_only(*_SHOWN))
            runs = {run.id: run for run in session.scalars(listed)}
            chosen = select(CriterionRow).where(
                CriterionRow.run.in_(numbers), CriterionRow.id == wanted.criterion
            )
            criteria = {one.run: one for one in session.scalars(chosen)} if wanted.criterion else {}
            tags: dict[int, list[str]] = {}
            for row in session.scalars(select(TagRow).where(TagRow.run.in_(numbers)).order_by(TagRow.tag)):
                tags.setdefault(row.run, []).append(row.tag)
            found = [_found(runs[one], criteria.get(one), tags.get(one, [])) for one in numbers]
            return FoundRuns(runs=found, total=session.scalar(count.where(*where)) or 0)

    def choices(self, plans: list[str]) -> RunChoices:
        """Values by which runs can be filtered; criteria of the newest runs of the plans, or of all."""
        newest = select(RunRow.id).order_by(RunRow.id.desc()).limit(_NEWEST)
        if plans:
            newest = newest.where(RunRow.plan.in_(plans))
        criteria = select(CriterionRow.id).where(CriterionRow.run.in_(newest)).distinct()
        with self._transaction() as session:

            def every(column: InstrumentedAttribute[str]) -> list[str]:
                asked = select(column).distinct().order_by(column).limit(_MOST_CHOICES)
                return [one for one in session.scalars(asked) if one]

            return RunChoices(
                benches=every(RunRow.bench),
                plans=every(RunRow.plan),
                duts=every(RunRow.dut),
                people=every(RunRow.requested_by),
                tags=every(TagRow.tag),
                criteria=sorted(session.scalars(criteria.limit(_MOST_CHOICES))),
            )

    def criteria_beside(self, run: int) -> str:
        """Criteria of a run, and those of the newest runs that passed and have one of its first, as JSON.

        By numbers of runs: `criteria`, of each what `_JUDGED` lists, by name; `settings`, each plan, bench
        and values. A text: what reads it is another process, and the service's loop does not go through it.
        """
        of_run = select(*_JUDGED).where(CriterionRow.run == run).order_by(CriterionRow.id)
        with self._transaction() as session:
            found = {run: [dict(row) for row in session.execute(of_run).mappings()]}
            if found[run]:
                passed = select(RunRow.id).join(CriterionRow, CriterionRow.run == RunRow.id)
                passed = passed.where(CriterionRow.id == found[run][0]["id"], RunRow.verdict == "pass")
                numbers = passed.where(RunRow.id != run).order_by(RunRow.id.desc()).limit(_MOST_PASSED)
                beside = select(CriterionRow.run, *_JUDGED).where(CriterionRow.run.in_(numbers))
                for row in session.execute(beside).mappings():
                    judged = dict(row)
                    found.setdefault(judged.pop("run"), []).append(judged)
            given = select(RunRow.id, RunRow.plan, RunRow.bench, RunRow.values_json).where(
                RunRow.id.in_(found)
            )
            settings = {number: others for number, *others in session.execute(given)}
        return json.dumps({"criteria": found, "settings": settings})


def _is(wanted: RunsWanted) -> ColumnElement[bool]:
    return and_(CriterionRow.run == RunRow.id, CriterionRow.id == wanted.criterion)


def _conditions(wanted: RunsWanted) -> list[ColumnElement[bool]]:
    chosen = [(column, getattr(wanted, name)) for name, column in _FILTERS.items()]
    found: list[ColumnElement[bool]] = [column.in_(values) for column, values in chosen if values]
    if wanted.tag:
        found.append(RunRow.id.in_(select(TagRow.run).where(TagRow.tag.in_(wanted.tag))))
    if wanted.since is not None:
        found.append(wanted.since <= _MOMENT)
    if wanted.until is not None:
        found.append(wanted.until > _MOMENT)
    if wanted.text:
        noted = select(NoteRow.run).where(NoteRow.text.icontains(wanted.text, autoescape=True))
        tagged = select(TagRow.run).where(TagRow.tag.icontains(wanted.text, autoescape=True))
        own = (column.icontains(wanted.text, autoescape=True) for column in _SEARCHED)
        found.append(or_(*own, RunRow.id.in_(noted), RunRow.id.in_(tagged)))
    if wanted.criterion and wanted.above is not None:
        found.append(CriterionRow.value >= wanted.above)
    if wanted.criterion and wanted.below is not None:
        found.append(CriterionRow.value <= wanted.below)
    return found


def _order(wanted: RunsWanted, orders: Mapping[str, ColumnElement[Any]]) -> list[UnaryExpression[Any]]:
    """The column asked for, what has no value last; equal ones newest first."""
    if wanted.sort == "run" or (wanted.sort == "value" and not wanted.criterion):
        return [RunRow.id.asc() if wanted.rising else RunRow.id.desc()]
    column = orders[wanted.sort]
    return [(column.asc() if wanted.rising else column.desc()).nulls_last(), RunRow.id.desc()]


def _took(dialect: str) -> ColumnElement[Any]:
    """From a run's beginning to its end; null of one that has not ended. SQLite keeps moments as texts."""
    if dialect == "sqlite":
        return func.julianday(RunRow.ended_at) - func.julianday(RunRow.started_at)
    return RunRow.ended_at - RunRow.started_at


def _found(run: RunRow, criterion: CriterionRow | None, tags: list[str]) -> FoundRun:
    if criterion is None:
        return FoundRun(run=run_data(run), tags=tags)
    return FoundRun(
        run=run_data(run),
        value=criterion.value,
        unit=criterion.unit,
        upper=criterion.upper,
        lower=criterion.lower,
        criterion_verdict=criterion.verdict,
        tags=tags,
    )
