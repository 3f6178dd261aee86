"""The audit log: only added to, each row with the hash of all before it.

A row's `chain` is the SHA-256 of the chain before it and of its own content; the first has that of the rows
that an earlier version wrote. A row that was changed, put in, replaced or taken out does not fit any more,
whatever was done to the database's own guards. What it does not prove: docs/how-to/serve.md.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass

from sqlalchemy import Engine, select, text
from sqlalchemy.orm import Session, sessionmaker

from hil.api_schemas.api import AuditEntry
from hil.core.errors.wording import shortened
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now
from hil.service.store._tables import AuditRow

_LONGEST_DETAIL = 2000
_ADDING = 0x61756469  # of two who add at once, one waits
_AT_ONCE = 1000
_BROKEN = "was changed, removed or inserted"


@dataclass(frozen=True)
class AuditHead:
    """The newest row and its chain; kept elsewhere, it shows that rows before it are all there."""

    id: int = 0
    chain: str = ""


@dataclass(frozen=True)
class AuditCheck:
    """Whether the log is as it was written: how many rows, the newest, and what is wrong; '' if nothing."""

    rows: int
    head: AuditHead
    problem: str = ""


@asked_apart
class LogStore:
    """The audit log."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def add(self, who: str, role: str, action: str, target: str, detail: str = "") -> None:
        """Write what somebody does."""
        row = AuditRow(
            at=now(),
            who=who,
            role=role,
            action=action,
            target=shortened(target, 200),
            detail=shortened(detail, _LONGEST_DETAIL),
        )
        with self._transaction() as session:
            _alone(session)
            newest = session.scalars(select(AuditRow).order_by(AuditRow.id.desc()).limit(1)).first()
            before = newest.chain if newest is not None else ""
            if not before:
                before = _of_unchained(session.scalars(select(AuditRow).order_by(AuditRow.id)))
            row.chain = _chained(before, row)
            session.add(row)

    def newest(self, before: int, most: int) -> list[AuditEntry]:
        """The newest entries before one."""
        chosen = select(AuditRow).where(AuditRow.id < before).order_by(AuditRow.id.desc()).limit(most)
        with self._transaction() as session:
            return [_entry(row) for row in session.scalars(chosen)]

    def check(self, known: AuditHead | None = None) -> AuditCheck:
        """Read the whole of it; `known` is a head that it had once, and has to have still."""
        rows, problem, known_there = 0, "", known is None or not known.id
        unchained: list[AuditRow] = []
        head = AuditHead()
        every = select(AuditRow).order_by(AuditRow.id).execution_options(yield_per=_AT_ONCE)
        with self._transaction() as session:
            for row in session.scalars(every):
                rows += 1
                if not row.chain and not head.chain:
                    unchained.append(row)
                    continue
                if row.chain != _chained(head.chain or _of_unchained(unchained), row):
                    problem = problem or f"{_in_words(row)}, or one just before it, {_BROKEN}"
                head = AuditHead(row.id, row.chain)
                known_there |= head == known
        if not problem and not known_there and known is not None:
            problem = f"row {known.id}, which was its newest once, is not there any more as it was"
        return AuditCheck(rows, head, problem)


def _alone(session: Session) -> None:
    """No one else adds a row before this transaction has ended."""
    if session.get_bind().dialect.name == "postgresql":
        session.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _ADDING})
    else:
        session.execute(text("BEGIN IMMEDIATE"))


def _of_unchained(rows: Iterable[AuditRow]) -> str:
    chain = ""
    for row in rows:
        chain = _chained(chain, row)
    return chain


def _chained(before: str, row: AuditRow) -> str:
    moment = aware(row.at)
    assert moment is not None
    content = row.who, row.role, row.action, row.target, row.detail
    everything = [before, moment.isoformat(timespec="microseconds"), *content]
    return hashlib.sha256(json.dumps(everything, ensure_ascii=True).encode()).hexdigest()


def _in_words(row: AuditRow) -> str:
    return f"row {row.id} of {aware(row.at):%Y-%m-%d %H:%M:%S} UTC"


def _entry(row: AuditRow) -> AuditEntry:
    at = aware(row.at)
    assert at is not None
    return AuditEntry(
        id=row.id, at=at, who=row.who, role=row.role, action=row.action, target=row.target, detail=row.detail
    )
