"""People who have signed in by OpenID Connect, and their sessions of the page."""

from __future__ import annotations

import datetime
import hashlib
import secrets

from sqlalchemy import ColumnElement, Engine, delete, func, or_, select
from sqlalchemy.orm import InstrumentedAttribute, Session, sessionmaker

from hil.api_schemas.api import Role
from hil.api_schemas.people import PersonData
from hil.core.errors.wording import shortened
from hil.service.stop_post import Owner
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now
from hil.service.store._tables import PersonRow, PersonSessionRow, TokenRow

_PREFIX = "hilperson_"
_LONGEST_NAME = 100


@asked_apart
class PersonStore:
    """A person is an issuer and a subject; the name, which stands in queue and reports, is theirs alone.

    A session is worth what the person's role is now: the next sign-in, on any machine, changes that of all.
    A name stays, whatever the provider calls somebody later: else they could approve what they asked for.
    """

    def __init__(self, engine: Engine) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin

    def sign_in(
        self, issuer: str, subject: str, name: str, role: Role, for_hours: float
    ) -> tuple[PersonData, str]:
        """Who they are here, and the secret of a new session."""
        secret, moment = _PREFIX + secrets.token_urlsafe(32), now()
        until = moment + datetime.timedelta(hours=for_hours)
        with self._transaction() as session:
            row = _row(session, issuer, subject)
            if row is None:
                row = PersonRow(issuer=issuer, subject=subject, name=_own_name(session, subject, name))
            row.role, row.signed_in_at = role, moment
            session.add(row)
            session.flush()
            session.execute(delete(PersonSessionRow).where(PersonSessionRow.until < moment))
            session.add(PersonSessionRow(sha256=_hashed(secret), person=row.id, until=until))
            return _person(row), secret

    def refuse(self, issuer: str, subject: str) -> None:
        """End all sessions of somebody who has no role any more."""
        with self._transaction() as session:
            row = _row(session, issuer, subject)
            if row is not None:
                session.execute(delete(PersonSessionRow).where(PersonSessionRow.person == row.id))

    def of_session(self, secret: str) -> PersonData | None:
        """Whose session it is; None if there is none, or it is over."""
        chosen = select(PersonRow).join(PersonSessionRow, PersonSessionRow.person == PersonRow.id)
        chosen = chosen.where(PersonSessionRow.sha256 == _hashed(secret), PersonSessionRow.until > now())
        with self._transaction() as session:
            row = session.scalars(chosen).first()
            return None if row is None else _person(row)

    def close_session(self, secret: str) -> None:
        """It is worth nothing from now on."""
        with self._transaction() as session:
            session.execute(delete(PersonSessionRow).where(PersonSessionRow.sha256 == _hashed(secret)))

    def close_all(self, person: int) -> PersonData | None:
        """End all sessions of somebody; None if there is no such person."""
        with self._transaction() as session:
            row = session.get(PersonRow, person)
            session.execute(delete(PersonSessionRow).where(PersonSessionRow.person == person))
            return None if row is None else _person(row)

    def all(self) -> list[PersonData]:
        """All who have ever signed in, in order of their names."""
        with self._transaction() as session:
            return [_person(row) for row in session.scalars(select(PersonRow).order_by(PersonRow.name))]

    def owners(self) -> dict[str, Owner]:
        """Whose all valid sessions are, by the SHA-256 of their secrets."""
        chosen = select(PersonSessionRow, PersonRow).join(PersonRow, PersonSessionRow.person == PersonRow.id)
        with self._transaction() as session:
            found = session.execute(chosen.where(PersonSessionRow.until > now()))
            return {opened.sha256: _owner(row, opened.until) for opened, row in found}


def _row(session: Session, issuer: str, subject: str) -> PersonRow | None:
    chosen = select(PersonRow).where(PersonRow.issuer == issuer, PersonRow.subject == subject)
    return session.scalars(chosen).first()


def _own_name(session: Session, subject: str, name: str) -> str:
    """The name, with the subject behind it where somebody else or a token has it: no one acts as another."""
    kept = shortened(name, max(15, _LONGEST_NAME - len(subject) - 3))
    for own in (name, shortened(f"{kept} ({subject})", _LONGEST_NAME)):
        people = select(PersonRow.id).where(_is(PersonRow.name, own))
        tokens = select(TokenRow.id).where(_is(TokenRow.name, own))
        if session.scalar(people) is None and session.scalar(tokens) is None:
            return own
    return f"{shortened(name, 60)} {secrets.token_hex(8)}"


def _is(column: InstrumentedAttribute[str], name: str) -> ColumnElement[bool]:
    """Whether it is the same name, in whatever case; SQLite knows that of ASCII only."""
    return or_(column == name, func.lower(column) == name.lower())


def _hashed(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


def _owner(row: PersonRow, until: datetime.datetime) -> Owner:
    moment = aware(until)
    assert moment is not None
    return Owner(name=row.name, role=row.role, until_s=moment.timestamp())


def _person(row: PersonRow) -> PersonData:
    return PersonData.model_validate(
        {
            "id": row.id,
            "issuer": row.issuer,
            "subject": row.subject,
            "name": row.name,
            "role": row.role,
            "signed_in_at": aware(row.signed_in_at),
        }
    )
