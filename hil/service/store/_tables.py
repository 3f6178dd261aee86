"""The tables of the store, and rows that are put in or change what is there, in one statement.

A change of a table needs a migration beside it; a test compares the two. One statement lets one of two who
try at once succeed.
"""

from __future__ import annotations

import datetime
from typing import Any

from sqlalchemy import BigInteger, ColumnElement, DateTime, Double, Index, String, Text, UniqueConstraint
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import DeclarativeBase, Mapped, Session, mapped_column

_MOMENT = DateTime(timezone=True)


class Base(DeclarativeBase):
    """All tables."""


class RunRow(Base):
    """A run; `plan_text` is the plan with its variables as chosen, `service` the one that has started it.

    `kept_at`: when the archive had all of its files. `dut`: the tested device, '' until it has ended.
    """

    __tablename__ = "runs"
    __table_args__ = (
        Index("runs_by_bench_and_state", "bench", "state"),
        # All that the list of runs is chosen by, so that rows with their plans' texts are not gone through.
        Index(
            "runs_listed",
            *("plan", "title", "bench", "verdict", "dut", "requested_by", "state", "ended_at", "queued_at"),
        ),
        Index("runs_by_end", "ended_at"),
    )

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    key: Mapped[str | None] = mapped_column(String(100), unique=True)
    plan: Mapped[str] = mapped_column(String(64))
    title: Mapped[str] = mapped_column(String(200))
    plan_text: Mapped[str] = mapped_column(Text)
    plan_source: Mapped[str] = mapped_column(Text)
    service: Mapped[str] = mapped_column(String(40), server_default="")
    bench: Mapped[str] = mapped_column(String(64))
    state: Mapped[str] = mapped_column(String(20))
    values_json: Mapped[str] = mapped_column(Text)
    priority: Mapped[int]
    hazard: Mapped[str] = mapped_column(String(500))
    confirmed_by: Mapped[str] = mapped_column(String(100))
    accept_expired: Mapped[str] = mapped_column(String(500))
    requested_by: Mapped[str] = mapped_column(String(100))
    approved_by: Mapped[str] = mapped_column(String(100))
    queued_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    started_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)
    ended_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)
    exit_code: Mapped[int | None]
    kept_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)
    verdict: Mapped[str | None] = mapped_column(String(10))
    safe_state: Mapped[str | None] = mapped_column(String(20))
    reason: Mapped[str] = mapped_column(Text)
    dut: Mapped[str] = mapped_column(String(200), server_default="")


class BenchRow(Base):
    """Which service drives a bench; `place` is where that runs, in words."""

    __tablename__ = "benches"

    bench: Mapped[str] = mapped_column(String(64), primary_key=True)
    service: Mapped[str] = mapped_column(String(40))
    place: Mapped[str] = mapped_column(String(300))
    until: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class AgentRow(Base):
    """A bench of an agent, and the service that hears it. `facts`: an `AgentBench` as JSON.

    `stop_by`: who asked for an emergency stop that the agent has not confirmed.
    """

    __tablename__ = "agents"

    bench: Mapped[str] = mapped_column(String(64), primary_key=True)
    agent: Mapped[str] = mapped_column(String(40))
    service: Mapped[str] = mapped_column(String(40))
    name: Mapped[str] = mapped_column(String(100))
    machine: Mapped[str] = mapped_column(String(100))
    version: Mapped[str] = mapped_column(String(40))
    facts: Mapped[str] = mapped_column(Text)
    heard_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    stop_by: Mapped[str] = mapped_column(String(100))


class CriterionRow(Base):
    """A criterion of a run that is over: what trends are made of."""

    __tablename__ = "criteria"
    __table_args__ = (Index("criteria_by_id", "id", "run", "value"),)

    run: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(200), primary_key=True)
    value: Mapped[float | None] = mapped_column(Double)
    unit: Mapped[str] = mapped_column(String(40))
    upper: Mapped[float | None] = mapped_column(Double)
    lower: Mapped[float | None] = mapped_column(Double)
    verdict: Mapped[str] = mapped_column(String(20))
    dut: Mapped[str] = mapped_column(String(200))


class FileRow(Base):
    """A file of a run that the archive has, as it was read back; `sha256` hexadecimal."""

    __tablename__ = "files"

    run: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(255), primary_key=True)
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(String(64))


class ResultRow(Base):
    """A study or a campaign of a service, for all; `facts`: its description as JSON.

    `place` is where its service runs, in words; `kept_at`: when the archive had all of its files.
    """

    __tablename__ = "results"

    kind: Mapped[str] = mapped_column(String(12), primary_key=True)
    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    service: Mapped[str] = mapped_column(String(40))
    place: Mapped[str] = mapped_column(String(300))
    facts: Mapped[str] = mapped_column(Text)
    kept_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)


class ResultFileRow(Base):
    """A file of a study or a campaign that the archive has, as it was read back; `sha256` hexadecimal."""

    __tablename__ = "result_files"

    kind: Mapped[str] = mapped_column(String(12), primary_key=True)
    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    name: Mapped[str] = mapped_column(String(255), primary_key=True)
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(String(64))


class NumberRow(Base):
    """The last number of a kind that was given to anything, also if that is removed."""

    __tablename__ = "numbers"

    kind: Mapped[str] = mapped_column(String(12), primary_key=True)
    last: Mapped[int]


class GivenRow(Base):
    """A plan, controller, model or bench file that somebody gave; `sha256` of its text, hexadecimal."""

    __tablename__ = "given"

    kind: Mapped[str] = mapped_column(String(12), primary_key=True)
    name: Mapped[str] = mapped_column(String(64), primary_key=True)
    sha256: Mapped[str] = mapped_column(String(64))
    text: Mapped[str] = mapped_column(Text)
    given_by: Mapped[str] = mapped_column(String(100))
    given_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    removed_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)


class VersionRow(Base):
    """A text that was given, kept when another takes its place; what was made of it is of its family."""

    __tablename__ = "given_versions"
    __table_args__ = (Index("given_versions_by_name", "kind", "name"),)

    kind: Mapped[str] = mapped_column(String(12), primary_key=True)
    family: Mapped[str] = mapped_column(String(64), primary_key=True)
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    name: Mapped[str] = mapped_column(String(64))
    sha256: Mapped[str] = mapped_column(String(64))
    text: Mapped[str] = mapped_column(Text)
    given_by: Mapped[str] = mapped_column(String(100))
    given_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class TokenRow(Base):
    """A token; `sha256` of its secret, which is 256 random bits."""

    __tablename__ = "tokens"

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    name: Mapped[str] = mapped_column(String(100))
    role: Mapped[str] = mapped_column(String(10))
    sha256: Mapped[str] = mapped_column(String(64), unique=True)
    made_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    revoked_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)
    expires_at: Mapped[datetime.datetime | None] = mapped_column(_MOMENT)


class SessionRow(Base):
    """A page that somebody opened with a token; `sha256` of what is in its cookie, 256 random bits."""

    __tablename__ = "sessions"

    sha256: Mapped[str] = mapped_column(String(64), primary_key=True)
    token: Mapped[int]
    until: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class PersonRow(Base):
    """Somebody whom a provider has vouched for; `role` as their groups had it when they signed in last."""

    __tablename__ = "people"
    __table_args__ = (UniqueConstraint("issuer", "subject", name="people_by_subject"),)

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    issuer: Mapped[str] = mapped_column(String(300))
    subject: Mapped[str] = mapped_column(String(255))
    name: Mapped[str] = mapped_column(String(100), unique=True)
    role: Mapped[str] = mapped_column(String(10))
    signed_in_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class PersonSessionRow(Base):
    """A page at which somebody has signed in; `sha256` of what is in its cookie, 256 random bits."""

    __tablename__ = "person_sessions"

    sha256: Mapped[str] = mapped_column(String(64), primary_key=True)
    person: Mapped[int]
    until: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class LeaseRow(Base):
    """Who has a bench for themselves."""

    __tablename__ = "leases"

    bench: Mapped[str] = mapped_column(String(64), primary_key=True)
    holder: Mapped[str] = mapped_column(String(100))
    until: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class LayoutRow(Base):
    """Plots that somebody has chosen for runs of a plan, as the page writes them."""

    __tablename__ = "layouts"

    person: Mapped[str] = mapped_column(String(100), primary_key=True)
    plan: Mapped[str] = mapped_column(String(64), primary_key=True)
    text: Mapped[str] = mapped_column(Text)
    kept_at: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class NoteRow(Base):
    """A note that somebody has added to a run."""

    __tablename__ = "notes"
    __table_args__ = (Index("notes_by_run", "run", "id"),)

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    run: Mapped[int]
    at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    who: Mapped[str] = mapped_column(String(100))
    text: Mapped[str] = mapped_column(Text)


class TagRow(Base):
    """A word by which a run is found."""

    __tablename__ = "tags"
    __table_args__ = (Index("tags_by_tag", "tag", "run"),)

    run: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    tag: Mapped[str] = mapped_column(String(40), primary_key=True)
    who: Mapped[str] = mapped_column(String(100))
    at: Mapped[datetime.datetime] = mapped_column(_MOMENT)


class AuditRow(Base):
    """Something that somebody did; the database itself refuses to change or remove it."""

    __tablename__ = "audit"

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    who: Mapped[str] = mapped_column(String(100))
    role: Mapped[str] = mapped_column(String(10))
    action: Mapped[str] = mapped_column(String(60))
    target: Mapped[str] = mapped_column(String(200))
    detail: Mapped[str] = mapped_column(Text)
    chain: Mapped[str] = mapped_column(String(64), server_default="")


def put(session: Session, table: type[Base], row: dict[str, Any], *, where: ColumnElement[bool]) -> bool:
    """Insert a row, or change that of the same key if it is as wanted; whether either was done."""
    insert = postgresql.insert if session.get_bind().dialect.name == "postgresql" else sqlite.insert
    keys = [column.name for column in table.__table__.primary_key]
    statement = insert(table).values(row)
    changed = {name: statement.excluded[name] for name in row if name not in keys}
    statement = statement.on_conflict_do_update(index_elements=keys, set_=changed, where=where)
    return session.execute(statement.returning(table.__table__.c[keys[0]])).first() is not None
