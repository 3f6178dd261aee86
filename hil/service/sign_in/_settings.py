"""Where people sign in, and what they may do: a TOML file given to `hil serve --sign-in`."""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Literal
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from hil.api_schemas.api import LADDER, Role
from hil.core.errors.mistakes import keyed, mistakes_of, refuse
from hil.core.files.toml_file import parse_toml, toml_text

_FIX = "see docs/how-to/sign-in.md"
_Text = Annotated[str, Field(min_length=1, max_length=300, pattern=r"^[^\x00-\x1f\x7f]+$")]


class SignInSettings(BaseModel):
    """The provider, this service as its client, and the role of each group.

    Attributes:
        name: of the provider, as the page shows it.
        issuer: its URL; its discovery document lies below it.
        client_secret_env: name of an environment variable; '' for a client without a secret.
        address: where people reach the page; the provider sends them back to `return_url`.
        groups_claim: of the ID token; a dot leads into an object (`realm_access.roles`).
        session_hours: how long somebody stays signed in, h: so late a change of groups counts at the latest.
        roles: by group; of several groups of a person the highest role counts.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    name: Annotated[_Text, Field(max_length=60)]
    issuer: _Text
    client_id: _Text
    client_secret_env: str = ""
    address: _Text
    scopes: tuple[_Text, ...] = Field(("openid", "profile"), strict=False)
    groups_claim: _Text = "groups"
    name_claim: _Text = "name"
    session_hours: Annotated[float, Field(gt=0, le=24, allow_inf_nan=False, strict=False)] = 12.0
    roles: Annotated[
        dict[_Text, Literal["viewer", "operator", "engineer", "admin"]], Field(min_length=1, max_length=200)
    ]

    @field_validator("issuer", "address")
    @classmethod
    def _safe(cls, url: str) -> str:
        if not is_safe(url):
            raise ValueError("must be https://HOST; http:// is for this machine only")
        parts = urlsplit(url)
        if parts.query or parts.fragment or parts.username is not None:
            raise ValueError("must have neither user nor query")
        return url

    @field_validator("address")
    @classmethod
    def _an_origin(cls, url: str) -> str:
        if urlsplit(url).path.strip("/"):
            raise ValueError("must have no path: the page is at the top of its host")
        return url.rstrip("/")

    @field_validator("client_secret_env")
    @classmethod
    def _there(cls, name: str) -> str:
        if name and not os.environ.get(name):
            raise ValueError(f"the environment has no {name}")
        return name

    @field_validator("scopes")
    @classmethod
    def _openid(cls, scopes: tuple[str, ...]) -> tuple[str, ...]:
        if "openid" not in scopes:
            raise ValueError("must have 'openid' among them")
        return scopes

    @property
    def secret(self) -> str:
        """'' if the client has none."""
        return os.environ.get(self.client_secret_env, "") if self.client_secret_env else ""

    @property
    def return_url(self) -> str:
        """Where the provider sends people back to; it has to be registered there."""
        return f"{self.address}/api/v1/sign-in/return"

    def role_of(self, groups: Iterable[str]) -> tuple[Role, str] | None:
        """The highest role of these groups, and the group that gives it; None if none has one."""
        found = [(self.roles[group], group) for group in groups if group in self.roles]
        return max(found, key=lambda one: LADDER.index(one[0]), default=None)


def is_safe(url: str) -> bool:
    """Whether a secret may be sent there: by TLS, or to this machine."""
    try:
        parts = urlsplit(url)
        host = parts.hostname or ""
    except ValueError:
        return False
    if parts.scheme != "http":
        return parts.scheme == "https" and bool(host)
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def read_settings(path: Path) -> SignInSettings:
    """Read the file.

    Raises:
        BadInputError: it cannot be read; or all its mistakes, with their lines.
    """
    text = toml_text(path, f"give the file of the sign-in: {_FIX}")
    try:
        return SignInSettings.model_validate(parse_toml(text, str(path), _FIX))
    except ValidationError as error:
        found = [keyed(one) for one in mistakes_of(error, SignInSettings)]
        refuse(str(path), found, text, _FIX)
        raise AssertionError("pydantic refused it without a mistake") from error
