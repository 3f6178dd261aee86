"""Opens the database: made if it is not there, and brought to today's tables."""

from __future__ import annotations

import datetime
import ssl
from functools import partial
from pathlib import Path
from typing import Any

import alembic.command
import alembic.config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, DateTime, Engine, create_engine, event, func, select, text
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError, SQLAlchemyError
from sqlalchemy.orm import Session

from hil.core.errors import BadInputError, BenchError
from hil.service.store._presence import in_words

_MIGRATIONS = Path(__file__).parent / "migrations"
_PG8000 = "postgresql+pg8000"
#: The service's loop waits for the database: for one that does not answer this long, once.
_WITHIN_S = 2
_MIGRATED_WITHIN_S = 30
_LOCKED_S = 10.0
_MIGRATING = 0x68696C  # no two services make the tables at once


def now() -> datetime.datetime:
    """This moment, with its zone."""
    return datetime.datetime.now(datetime.UTC)


def now_there(session: Session) -> datetime.datetime:
    """This moment by the database's clock, which services on several machines share."""
    moment = aware(session.scalar(select(func.current_timestamp(type_=DateTime(timezone=True)))))
    assert moment is not None
    return moment


def aware(moment: datetime.datetime | None) -> datetime.datetime | None:
    """A moment as it was stored, in UTC; SQLite forgets that zone, PostgreSQL tells its server's."""
    if moment is None or moment.tzinfo is not None:
        return moment and moment.astimezone(datetime.UTC)
    return moment.replace(tzinfo=datetime.UTC)


def open_database(url: str, locked_s: float = _LOCKED_S) -> Engine:
    """Open it, with all migrations done.

    Args:
        locked_s: how long a statement waits for an SQLite that another process writes to.
        url: `sqlite:////data/service.sqlite`, `postgresql://user@host/name`; of other drivers as SQLAlchemy
            has it.

    Raises:
        BadInputError: no such kind of database, or one of a newer version of this software.
        BenchError: it cannot be reached or written.
    """
    try:
        chosen, options = _for_driver(make_url(url))
        if chosen.drivername == _PG8000:
            options["timeout"] = _MIGRATED_WITHIN_S
        migrating = _engine(chosen, options, _LOCKED_S)
    except (ArgumentError, NoSuchModuleError, ImportError, ValueError, TypeError, OSError) as error:
        raise BadInputError(
            f"no database can be opened by this URL: {_cannot(error)}",
            where="--database",
            fix="sqlite:////folder/file or postgresql://user@host/name (pip install 'eaxle-hil[postgresql]')",
        ) from error
    shown = chosen.render_as_string(hide_password=True)
    try:
        _migrate(migrating, shown)
    except (SQLAlchemyError, OSError) as error:
        raise BenchError(
            f"the database cannot be used: {in_words(error.__cause__ or error)}",
            where=shown,
            fix="check that it exists and is writable",
        ) from error
    finally:
        migrating.dispose()
    return _engine(chosen, options | ({"timeout": _WITHIN_S} if "timeout" in options else {}), locked_s)


def _engine(url: URL, options: dict[str, Any], locked_s: float) -> Engine:
    engine = create_engine(url, connect_args=options)
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", partial(_settle, round(1e3 * locked_s)))
    return engine


def _for_driver(url: URL) -> tuple[URL, dict[str, Any]]:
    """The URL, with what stands in it as libpq has it, for the driver that this software brings.

    `host=/folder` is that of a socket; `sslmode=verify-full`, with `sslrootcert`, has TLS with the server's
    certificate checked, `sslmode=require` without. Without `sslmode` there is TLS if the server has it.
    """
    if url.drivername in ("postgres", "postgresql"):
        url = url.set(drivername=_PG8000)
    options: dict[str, Any] = {}
    if url.get_backend_name() not in ("sqlite", "postgresql"):
        raise ValueError("neither SQLite nor PostgreSQL")
    if url.drivername != _PG8000:
        return url, options
    query = {name: str(value) for name, value in url.query.items()}
    folder, mode, roots = (query.pop(name, "") for name in ("host", "sslmode", "sslrootcert"))
    if folder:
        options["unix_sock"] = f"{folder}/.s.PGSQL.{url.port or 5432}"
    if mode not in ("", "disable", "prefer", "require", "verify-full"):
        raise ValueError(f"sslmode is '{mode}'; disable, prefer, require, verify-full are known")
    if mode in ("require", "verify-full"):
        options["ssl_context"] = context = ssl.create_default_context(cafile=roots or None)
        if mode == "require":
            context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    elif mode == "disable":
        options["ssl_context"] = False
    return url.set(query=query), options


def _cannot(error: Exception) -> str:
    """Why, without what may be a password."""
    kinds = {ImportError: "its driver is not installed", ArgumentError: "it is not a URL"}
    known = next((words for kind, words in kinds.items() if isinstance(error, kind)), "")
    if isinstance(error, OSError):
        return f"sslrootcert cannot be read: {error.strerror}"
    ours = str(error).startswith(("sslmode is", "neither"))
    return known or (str(error) if ours else type(error).__name__)


def _settle(locked_ms: int, connection: object, record: object) -> None:
    """A commit is on the disk when it returns, also through a power cut; readers do not wait for writers."""
    del record
    cursor = connection.cursor()  # type: ignore[attr-defined]
    for setting in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", f"busy_timeout={locked_ms}"):
        cursor.execute(f"PRAGMA {setting}")
    cursor.close()


def _migrate(engine: Engine, shown: str) -> None:
    config = alembic.config.Config()
    config.set_main_option("script_location", str(_MIGRATIONS))
    config.set_main_option("path_separator", "os")
    known = {script.revision for script in ScriptDirectory.from_config(config).walk_revisions()}
    with engine.begin() as connection:
        _alone(connection)
        there = MigrationContext.configure(connection).get_current_revision()
        if there is not None and there not in known:
            raise BadInputError(
                f"the database has tables of a newer version ('{there}')",
                where=shown,
                fix="install that version, or give another folder with --data",
            )
        config.attributes["connection"] = connection
        alembic.command.upgrade(config, "head")


def _alone(connection: Connection) -> None:
    """Let others wait until the transaction has ended."""
    if connection.dialect.name == "postgresql":
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _MIGRATING})
