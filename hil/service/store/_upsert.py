"""Rows that are put in, or change what is there: one statement, so that of two who try one does."""

from __future__ import annotations

from typing import Any

from sqlalchemy import ColumnElement
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from hil.service.store._tables import Base


def put(session: Session, table: type[Base], row: dict[str, Any], *, where: ColumnElement[bool]) -> bool:
    """Insert a row, or change that of the same key if it is as wanted; whether either was done."""
    insert = postgresql.insert if session.get_bind().dialect.name == "postgresql" else sqlite.insert
    keys = [column.name for column in table.__table__.primary_key]
    statement = insert(table).values(row)
    changed = {name: statement.excluded[name] for name in row if name not in keys}
    statement = statement.on_conflict_do_update(index_elements=keys, set_=changed, where=where)
    return session.execute(statement.returning(table.__table__.c[keys[0]])).first() is not None
