"""Tokens of those who may do something, and what was done by whom."""

from __future__ import annotations

import hashlib
import secrets

from sqlalchemy import Engine, func, select, update
from sqlalchemy.orm import sessionmaker

from hil.service.data import AuditEntry, Role, TokenData, TokenMade
from hil.service.stop_post import Owner
from hil.service.store._opening import aware, now
from hil.service.store._tables import AuditRow, TokenRow

_PREFIX = "hil_"  # so that a secret that went astray is known as one
_LONGEST_DETAIL = 2000


class TokenStore:
    """Tokens: 256 random bits each, of which only the SHA-256 is kept.

    A slow hash protects what people think up; of random bits nothing can be guessed however fast it is.
    """

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def make(self, name: str, role: Role) -> TokenMade:
        """Make a token; its secret is told this once."""
        secret = _PREFIX + secrets.token_urlsafe(32)
        row = TokenRow(name=name, role=role, sha256=_hashed(secret), made_at=now())
        with self._transaction() as session:
            session.add(row)
            session.flush()
            return TokenMade(token=_token(row), secret=secret)

    def owner_of(self, secret: str) -> TokenData | None:
        """Whose token it is; None if it is none, or was revoked."""
        with self._transaction() as session:
            chosen = select(TokenRow).where(TokenRow.sha256 == _hashed(secret), TokenRow.revoked_at.is_(None))
            row = session.scalars(chosen).first()
            return None if row is None else _token(row)

    def owners(self) -> dict[str, Owner]:
        """Whose all valid tokens are, by the SHA-256 of their secrets."""
        with self._transaction() as session:
            chosen = select(TokenRow).where(TokenRow.revoked_at.is_(None))
            return {row.sha256: Owner(name=row.name, role=row.role) for row in session.scalars(chosen)}

    def any(self) -> bool:
        """Whether a token is valid."""
        with self._transaction() as session:
            valid = select(func.count()).select_from(TokenRow).where(TokenRow.revoked_at.is_(None))
            return bool(session.scalar(valid))

    def all(self) -> list[TokenData]:
        """All, also those that were revoked."""
        with self._transaction() as session:
            return [_token(row) for row in session.scalars(select(TokenRow).order_by(TokenRow.id))]

    def revoke(self, token: int) -> bool:
        """Make a token worthless; false if there is none that is valid."""
        with self._transaction() as session:
            valid = update(TokenRow).where(TokenRow.id == token, TokenRow.revoked_at.is_(None))
            return bool(session.execute(valid.values(revoked_at=now())).rowcount)  # type: ignore[attr-defined]


class LogStore:
    """The audit log: only added to."""

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def add(self, who: str, role: str, action: str, target: str, detail: str = "") -> None:
        """Write what somebody does."""
        row = AuditRow(
            at=now(), who=who, role=role, action=action, target=target[:200], detail=detail[:_LONGEST_DETAIL]
        )
        with self._transaction() as session:
            session.add(row)

    def newest(self, before: int, most: int) -> list[AuditEntry]:
        """The newest entries before one."""
        chosen = select(AuditRow).where(AuditRow.id < before).order_by(AuditRow.id.desc()).limit(most)
        with self._transaction() as session:
            return [_entry(row) for row in session.scalars(chosen)]


def _hashed(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


def _token(row: TokenRow) -> TokenData:
    return TokenData.model_validate(
        {
            "id": row.id,
            "name": row.name,
            "role": row.role,
            "made_at": aware(row.made_at),
            "revoked_at": aware(row.revoked_at),
        }
    )


def _entry(row: AuditRow) -> AuditEntry:
    at = aware(row.at)
    assert at is not None
    return AuditEntry(
        id=row.id, at=at, who=row.who, role=row.role, action=row.action, target=row.target, detail=row.detail
    )
