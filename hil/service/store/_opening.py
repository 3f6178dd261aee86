"""Opens the database: made if it is not there, and brought to today's tables."""

from __future__ import annotations

import datetime
from pathlib import Path

import alembic.command
import alembic.config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Engine, create_engine, event
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError, SQLAlchemyError

from hil.core.errors import BadInputError, BenchError

_MIGRATIONS = Path(__file__).parent / "migrations"


def now() -> datetime.datetime:
    """This moment, with its zone."""
    return datetime.datetime.now(datetime.UTC)


def aware(moment: datetime.datetime | None) -> datetime.datetime | None:
    """A moment as it was stored; SQLite forgets the zone, which is always UTC."""
    return moment.replace(tzinfo=datetime.UTC) if moment is not None and moment.tzinfo is None else moment


def open_database(url: str) -> Engine:
    """Open it, with all migrations done.

    Args:
        url: as SQLAlchemy has it: `sqlite:////data/service.sqlite`, `postgresql+psycopg://…`.

    Raises:
        BadInputError: no such kind of database, or one of a newer version of this software.
        BenchError: it cannot be reached or written.
    """
    try:
        shown = make_url(url).render_as_string(hide_password=True)
        engine = create_engine(url, pool_pre_ping=True)
    except (ArgumentError, NoSuchModuleError, ImportError, ValueError) as error:
        raise BadInputError(
            f"no database can be opened by this URL: {type(error).__name__}",
            where="--database",
            fix="sqlite:////folder/file or postgresql+psycopg://user@host/name",
        ) from error
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _settle)
    try:
        _migrate(engine, shown)
    except SQLAlchemyError as error:
        raise BenchError(
            f"the database cannot be used: {str(error.__cause__ or error).strip()[:300]}",
            where=shown,
            fix="look whether it is there, and whether it may be written",
        ) from error
    return engine


def _settle(connection: object, record: object) -> None:
    """A commit is on the disk when it returns, also through a power cut; readers do not wait for writers."""
    del record
    cursor = connection.cursor()  # type: ignore[attr-defined]
    for setting in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", "busy_timeout=10000"):
        cursor.execute(f"PRAGMA {setting}")
    cursor.close()


def _migrate(engine: Engine, shown: str) -> None:
    config = alembic.config.Config()
    config.set_main_option("script_location", str(_MIGRATIONS))
    config.set_main_option("path_separator", "os")
    known = {script.revision for script in ScriptDirectory.from_config(config).walk_revisions()}
    with engine.begin() as connection:
        there = MigrationContext.configure(connection).get_current_revision()
        if there is not None and there not in known:
            raise BadInputError(
                f"the database has tables of a newer version ('{there}')",
                where=shown,
                fix="install that version, or give another folder with --data",
            )
        config.attributes["connection"] = connection
        alembic.command.upgrade(config, "head")
