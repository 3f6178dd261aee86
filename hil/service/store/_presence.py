"""Whether the database answers: known at once, so that no one waits twice for one that is away."""

from __future__ import annotations

import contextlib
import contextvars
import datetime
import logging
from typing import Any

from sqlalchemy import Dialect, Engine, event, text
from sqlalchemy.engine import ExceptionContext
from sqlalchemy.engine.interfaces import DBAPIConnection
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.pool import ConnectionPoolEntry

from hil.core.errors import BenchError
from hil.core.errors.wording import shortened

#: Classes of SQLSTATE (PostgreSQL, appendix A) that are about a statement; all others are about the server.
_OF_THE_STATEMENT = ("21", "22", "23", "42", "P0")
_LONGEST = 200
_asking = contextvars.ContextVar("asking", default=False)

logger = logging.getLogger(__name__)
# A connection that is gone cannot be closed properly either: what happened is reported here, once.
logging.getLogger("sqlalchemy.pool").setLevel(logging.CRITICAL)


class DatabaseAwayError(BenchError):
    """The database does not answer, or cannot do its work now."""


class Presence:
    """Knows from failures that a database is away, and asks it from time to time whether it is back.

    While it is away every other use fails at once with DatabaseAwayError, without asking the network.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._shown = engine.url.render_as_string(hide_password=True)
        self._why = ""
        self._since = ""
        event.listen(engine, "handle_error", self._failed, retval=True)
        event.listen(engine, "do_connect", self._connect)

    @property
    def away(self) -> str:
        """Why and since when it is away; '' if it is not."""
        return f"the database cannot be reached since {self._since}: {self._why}" if self._why else ""

    def ask(self) -> bool:
        """Whether it answers now. May take as long as the network does: for a thread of its own."""
        token = _asking.set(True)
        try:
            with self._engine.connect() as connection:
                # An SQLite that is locked can be read, and not be worked with.
                locking = "BEGIN IMMEDIATE" if self._engine.dialect.name == "sqlite" else "SELECT 1"
                connection.execute(text(locking))
                connection.rollback()
        except (SQLAlchemyError, DatabaseAwayError):
            return False
        finally:
            _asking.reset(token)
        if self._why:
            logger.warning("the database answers again: %s", self._shown)
        self._why = ""
        return True

    def error(self) -> DatabaseAwayError:
        """What those hear who need it."""
        return DatabaseAwayError(
            self.away,
            where=self._shown,
            fix="active runs continue, emergency stops work; check its server, then try again",
        )

    def _connect(
        self, dialect: Dialect, record: ConnectionPoolEntry, arguments: list[Any], options: dict[str, Any]
    ) -> DBAPIConnection:
        del record
        if self._why and not _asking.get():
            raise self.error()
        try:
            return dialect.connect(*arguments, **options)
        except OSError as failure:  # pg8000 gives a server's silence as it is
            raise self._away_for(failure) from failure

    def _failed(self, context: ExceptionContext) -> BaseException | None:
        failure = context.original_exception
        if not _of_the_server(context):
            return None
        context.is_disconnect = True
        return self._away_for(failure)

    def _away_for(self, failure: BaseException) -> DatabaseAwayError:
        reason = in_words(failure)
        if not self._why:
            self._since = f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d %H:%M:%S} UTC"
            logger.error("the database is away: %s: %s", self._shown, reason)
        self._why = reason
        return self.error()


def in_words(failure: BaseException) -> str:
    """What a database's driver says, on a line: pg8000 gives the server's fields as a dict."""
    of_system = failure if isinstance(failure, OSError) else failure.__cause__
    first = failure.args[0] if failure.args else ""
    if isinstance(of_system, OSError):
        words = of_system.strerror or str(of_system)
    else:
        words = str(first.get("M", "")) if isinstance(first, dict) else str(failure)
    with contextlib.suppress(IndexError):
        words = words.strip().splitlines()[0]
    return shortened(words, _LONGEST) or type(failure).__name__


def _of_the_server(context: ExceptionContext) -> bool:
    failure = context.original_exception
    if (
        context.is_disconnect
        or isinstance(failure, OSError)
        or type(failure).__name__ in ("InterfaceError", "OperationalError")
    ):
        return True
    state = _sqlstate(failure)
    return bool(state) and not state.startswith(_OF_THE_STATEMENT)


def _sqlstate(failure: BaseException) -> str:
    first = failure.args[0] if failure.args else None
    return str(first.get("C", "")) if isinstance(first, dict) else str(getattr(failure, "sqlstate", "") or "")
