"""Who gets which notices: a TOML file given to `hil serve --notices` (docs/how-to/notices.md)."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Annotated, Literal, TypeVar
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from hil.core.errors import BadInputError
from hil.core.errors.mistakes import keyed, mistakes_of, refuse
from hil.core.files.toml_file import parse_toml, toml_text

#: `run_failed` is any end but `pass` and `done`; a limit that trips is one of them.
Event = Literal[
    "run_ended", "run_failed", "limit_tripped", "approval_asked", "bench_stopped", "drift", "test"
]
EVENTS: tuple[Event, ...] = ("run_failed", "approval_asked", "bench_stopped", "drift")

R = TypeVar("R", bound="_Recipient")
_ADDRESS = re.compile(r"[^\s@<>,]+@[^\s@<>,]+")


def _mail_address(text: str) -> str:
    if not _ADDRESS.fullmatch(text):
        raise ValueError("must be one address, as name@example.org")
    return text


_Address = Annotated[str, Field(max_length=254), AfterValidator(_mail_address)]
_FIX = "see docs/how-to/notices.md"


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Recipient(_Table):
    """Which notices go there: of these events, of these benches (all if none is named)."""

    events: tuple[Event, ...] = EVENTS
    benches: tuple[str, ...] = ()

    def wants(self, event: Event, bench: str) -> bool:
        """Whether a notice goes there; a test goes everywhere."""
        if event == "test":
            return True
        return event in self.events and (not self.benches or bench in self.benches)


def _sound(table: R, wrong: list[str]) -> R:
    if wrong:
        raise ValueError("; ".join(wrong))
    return table


def _is_address(url: str) -> bool:
    try:
        parts = urlsplit(url)
    except ValueError:
        return False
    return parts.scheme in ("http", "https") and bool(parts.hostname)


class Webhook(_Recipient):
    """An address that notices are posted to as JSON, signed with the secret in `secret_env`."""

    url: str
    secret_env: str = ""

    @model_validator(mode="after")
    def _usable(self) -> Webhook:
        wrong = []
        if not _is_address(self.url):  # which is not repeated: it may be a secret
            wrong.append("url must begin with https:// or http:// and name a host")
        if self.secret_env and not os.environ.get(self.secret_env):
            wrong.append(f"the environment has no {self.secret_env}")
        return _sound(self, wrong)

    @property
    def name(self) -> str:
        """For messages: without what may be a secret in the path."""
        parts = urlsplit(self.url)
        return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}"

    @property
    def secret(self) -> str:
        """'' if notices are not signed."""
        return os.environ.get(self.secret_env, "") if self.secret_env else ""


class Mail(_Recipient):
    """People who get mail by an SMTP server."""

    host: str
    port: Annotated[int, Field(ge=1, le=65535)] = 587
    security: Literal["starttls", "tls", "none"] = "starttls"
    user: str = ""
    password_env: str = ""
    sender: _Address
    to: Annotated[tuple[_Address, ...], Field(min_length=1, max_length=100)]

    @model_validator(mode="after")
    def _usable(self) -> Mail:
        wrong = []
        if bool(self.user) != bool(self.password_env):
            wrong.append("user and password_env go together")
        if self.password_env and not os.environ.get(self.password_env):
            wrong.append(f"the environment has no {self.password_env}")
        if self.user and self.security == "none":
            wrong.append("a password is not sent without encryption: set security to starttls or tls")
        return _sound(self, wrong)

    @property
    def name(self) -> str:
        """For messages."""
        return f"mail to {', '.join(self.to)}"

    @property
    def password(self) -> str:
        """'' if none is needed."""
        return os.environ.get(self.password_env, "") if self.password_env else ""


Recipient = Webhook | Mail


class NoticeSettings(_Table):
    """All who get notices. `address` is where people reach the service's page, for links."""

    address: str = ""
    webhook: tuple[Webhook, ...] = ()
    mail: tuple[Mail, ...] = ()

    @property
    def recipients(self) -> tuple[Recipient, ...]:
        """Webhooks, then mail."""
        return (*self.webhook, *self.mail)


def read_settings(path: Path) -> NoticeSettings:
    """Read the file.

    Raises:
        BadInputError: it cannot be read; or all its mistakes, with their lines.
    """
    text = toml_text(path, f"give the file of who gets notices: {_FIX}")
    table = parse_toml(text, str(path), _FIX)
    try:
        found = NoticeSettings.model_validate(table)
    except ValidationError as error:
        refuse(str(path), [keyed(one) for one in mistakes_of(error, NoticeSettings)], text, _FIX)
        raise AssertionError("pydantic refused it without a mistake") from error
    if not found.recipients:
        raise BadInputError("has no recipient", where=str(path), fix=f"add [[webhook]] or [[mail]]: {_FIX}")
    return found
