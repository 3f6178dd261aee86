"""Tokens of those who may do something, and sessions of the page that somebody with a token has opened."""

from __future__ import annotations

import datetime
import hashlib
import secrets

from sqlalchemy import ColumnElement, Engine, delete, func, or_, select, update
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.api import Role, TokenData, TokenMade
from hil.service.stop_post import Owner
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now
from hil.service.store._tables import SessionRow, TokenRow

_PREFIX, _SESSION_PREFIX = "hil_", "hilsession_"  # so that a secret that went astray is known as one
SESSION_S = 12 * 3600.0


@asked_apart
class TokenStore:
    """Tokens: 256 random bits each, of which only the SHA-256 is kept.

    A slow hash protects what people think up; of random bits nothing can be guessed however fast it is.
    """

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def make(self, name: str, role: Role, for_days: float | None = None) -> TokenMade:
        """Make a token; its secret is shown this once. None: it is valid until it is revoked."""
        secret = _PREFIX + secrets.token_urlsafe(32)
        expires_at = None if for_days is None else now() + datetime.timedelta(days=for_days)
        row = TokenRow(name=name, role=role, sha256=_hashed(secret), made_at=now(), expires_at=expires_at)
        with self._transaction() as session:
            session.add(row)
            session.flush()
            return TokenMade(token=_token(row), secret=secret)

    def owner_of(self, secret: str) -> TokenData | None:
        """Whose token it is; None if it is none, has expired, or was revoked."""
        with self._transaction() as session:
            chosen = select(TokenRow).where(TokenRow.sha256 == _hashed(secret), *_valid())
            row = session.scalars(chosen).first()
            return None if row is None else _token(row)

    def open_session(self, token: TokenData) -> str:
        """The secret of a session: it ends with its token, after twelve hours, or when it is closed."""
        secret, moment = _SESSION_PREFIX + secrets.token_urlsafe(32), now()
        until = moment + datetime.timedelta(seconds=SESSION_S)
        if token.expires_at is not None:
            until = min(until, token.expires_at)
        with self._transaction() as session:
            session.execute(delete(SessionRow).where(SessionRow.until < moment))
            session.add(SessionRow(sha256=_hashed(secret), token=token.id, until=until))
        return secret

    def owner_of_session(self, secret: str) -> TokenData | None:
        """Whose session it is; None if there is none, or its token is not valid any more."""
        chosen = select(TokenRow).join(SessionRow, SessionRow.token == TokenRow.id)
        chosen = chosen.where(SessionRow.sha256 == _hashed(secret), SessionRow.until > now(), *_valid())
        with self._transaction() as session:
            row = session.scalars(chosen).first()
            return None if row is None else _token(row)

    def close_session(self, secret: str) -> None:
        """It is worth nothing from now on."""
        with self._transaction() as session:
            session.execute(delete(SessionRow).where(SessionRow.sha256 == _hashed(secret)))

    def owners(self) -> dict[str, Owner]:
        """Whose all valid tokens and sessions are, by the SHA-256 of their secrets."""
        sessions = select(SessionRow, TokenRow).join(TokenRow, SessionRow.token == TokenRow.id)
        with self._transaction() as session:
            tokens = session.scalars(select(TokenRow).where(*_valid()))
            found = {row.sha256: _owner(row, row.expires_at) for row in tokens}
            for opened, row in session.execute(sessions.where(SessionRow.until > now(), *_valid())):
                found[opened.sha256] = _owner(row, opened.until)
            return found

    def any(self) -> bool:
        """Whether there is a token that was not revoked; one that has expired locks the door, too."""
        with self._transaction() as session:
            given = select(func.count()).select_from(TokenRow).where(TokenRow.revoked_at.is_(None))
            return bool(session.scalar(given))

    def all(self) -> list[TokenData]:
        """All, also those that were revoked or have expired."""
        with self._transaction() as session:
            return [_token(row) for row in session.scalars(select(TokenRow).order_by(TokenRow.id))]

    def revoke(self, token: int) -> bool:
        """Make a token and its sessions worthless; false if there is none that was not revoked before."""
        with self._transaction() as session:
            there = update(TokenRow).where(TokenRow.id == token, TokenRow.revoked_at.is_(None))
            session.execute(delete(SessionRow).where(SessionRow.token == token))
            return bool(session.execute(there.values(revoked_at=now())).rowcount)  # type: ignore[attr-defined]


def _valid() -> tuple[ColumnElement[bool], ...]:
    return TokenRow.revoked_at.is_(None), or_(TokenRow.expires_at.is_(None), TokenRow.expires_at > now())


def _hashed(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


def _owner(row: TokenRow, until: datetime.datetime | None) -> Owner:
    moment = aware(until)
    return Owner(name=row.name, role=row.role, until_s=moment.timestamp() if moment is not None else None)


def _token(row: TokenRow) -> TokenData:
    return TokenData.model_validate(
        {
            "id": row.id,
            "name": row.name,
            "role": row.role,
            "made_at": aware(row.made_at),
            "expires_at": aware(row.expires_at),
            "revoked_at": aware(row.revoked_at),
        }
    )
