"""Tokens end, a page's cookie is no token, and no one else reads the folder of a service."""

from __future__ import annotations

import contextlib
import datetime
import http.client
import stat
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from sqlalchemy import Engine

from hil.service.serving import make_token
from hil.service.stop_post import COOKIE
from hil.service.store import TokenStore
from tests.hil.service.served import RefusedError, Served, environment_of, served

_SHORT_DAYS = 1e-9


def test_a_token_ends_by_itself_and_still_locks_the_door(engine: Engine) -> None:
    tokens = TokenStore(engine)
    short, long = tokens.make("anna", "operator", _SHORT_DAYS), tokens.make("bert", "viewer", 1.0)
    time.sleep(1e-3)
    assert tokens.owner_of(short.secret) is None
    assert tokens.owner_of(long.secret) == long.token
    assert [one.name for one in tokens.owners().values()] == ["bert"]
    tokens.revoke(long.token.id)
    assert tokens.any()  # else everybody would be let in once the last has expired


def test_a_session_ends_with_its_token_or_when_it_is_closed(engine: Engine) -> None:
    tokens = TokenStore(engine)
    made = tokens.make("anna", "operator", 1.0)
    one, other = tokens.open_session(made.token), tokens.open_session(made.token)
    assert len({one, other, made.secret}) == 3
    assert tokens.owner_of_session(one) == made.token
    assert tokens.owner_of(one) is None
    assert tokens.owner_of_session(made.secret) is None
    assert len(tokens.owners()) == 3
    tokens.close_session(one)
    assert (tokens.owner_of_session(one), tokens.owner_of_session(other)) == (None, made.token)
    tokens.revoke(made.token.id)
    assert tokens.owner_of_session(other) is None
    ending = tokens.make("bert", "operator", _SHORT_DAYS)
    assert tokens.owner_of_session(tokens.open_session(ending.token)) is None


@pytest.mark.slow
def test_the_cookie_is_no_token_and_is_secure_behind_a_trusted_proxy(tmp_path: Path) -> None:
    data = tmp_path / "data"
    database = environment_of(data)["HIL_DATABASE"]
    secret = make_token(data, database, "anna", "admin", 30.0).secret
    with served(data, "--trusted-proxy", "127.0.0.1", state=tmp_path / "state", token=secret) as service:
        plain, behind = _logged_in(service, secret), _logged_in(service, secret, "https")
        assert "secure" not in plain.lower()
        assert "; secure" in behind.lower()
        session = plain.partition("=")[2].partition(";")[0]
        assert session != secret
        assert _as(service, {"cookie": f"{COOKIE}={session}"}) == 200
        assert _as(service, {"cookie": f"{COOKIE}={secret}"}) == 401
        assert _as(service, {"authorization": f"Bearer {session}"}) == 401
        assert _as(service, {"cookie": f"{COOKIE}={session}"}, "DELETE", "/session") == 204
        assert _as(service, {"cookie": f"{COOKIE}={session}"}) == 401
        (token,) = service.get("/tokens")
        left = datetime.datetime.fromisoformat(token["expires_at"]) - datetime.datetime.now(datetime.UTC)
        assert left > datetime.timedelta(days=29)


@pytest.mark.slow
def test_a_header_of_a_proxy_that_is_not_trusted_makes_no_cookie_secure(tmp_path: Path) -> None:
    data = tmp_path / "data"
    database = environment_of(data)["HIL_DATABASE"]
    secret = make_token(data, database, "anna", "admin").secret
    with served(data, state=tmp_path / "state", token=secret) as service:
        assert "secure" not in _logged_in(service, secret, "https").lower()


@pytest.mark.slow
def test_an_expired_token_opens_nothing(tmp_path: Path) -> None:
    data = tmp_path / "data"
    database = environment_of(data)["HIL_DATABASE"]
    secret = make_token(data, database, "anna", "admin", _SHORT_DAYS).secret
    with served(data, state=tmp_path / "state", token=secret) as service:
        for token in (secret, ""):
            with pytest.raises(RefusedError) as refused:
                service.ask("GET", "/api/v1/me", token=token)
            assert refused.value.status == 401


@pytest.mark.slow
def test_what_is_shown_live_ends_with_the_token_or_session_that_asked(tmp_path: Path) -> None:
    data = tmp_path / "data"
    database = environment_of(data)["HIL_DATABASE"]
    secret = make_token(data, database, "anna", "admin").secret
    with served(data, state=tmp_path / "state", token=secret) as service:
        made = service.post("/tokens", {"name": "bert", "role": "viewer"})
        session = _logged_in(service, secret).partition(";")[0]
        with (
            _live(service, {"authorization": f"Bearer {made['secret']}"}) as revoked,
            _live(service, {"cookie": session}) as closed,
            _live(service, {"authorization": f"Bearer {secret}"}) as valid,
        ):
            for one in (revoked, closed, valid):
                assert _next(one) == "state"
            service.ask("DELETE", f"/api/v1/tokens/{made['token']['id']}")
            assert _last(revoked) == "signed_out"
            assert _as(service, {"cookie": session}, "DELETE", "/session") == 204
            assert _last(closed) == "signed_out"
            assert _next(valid) in ("here", "state")


def test_the_folder_is_the_owners_alone(tmp_path: Path) -> None:
    data = tmp_path / "data"
    data.mkdir(mode=0o755)
    make_token(data, environment_of(data)["HIL_DATABASE"], "anna", "viewer")
    assert stat.S_IMODE(data.stat().st_mode) == 0o700


def _logged_in(service: Served, secret: str, proto: str = "") -> str:
    """The cookie that is set."""
    where = urlsplit(service.url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    headers = {"content-type": "application/json"} | ({"x-forwarded-proto": proto} if proto else {})
    try:
        connection.request("POST", "/api/v1/session", f'{{"secret": "{secret}"}}', headers)
        answer = connection.getresponse()
        assert answer.status == 204
        return str(answer.getheader("set-cookie"))
    finally:
        connection.close()


@contextlib.contextmanager
def _live(service: Served, headers: dict[str, str]) -> Iterator[http.client.HTTPResponse]:
    where = urlsplit(service.url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    try:
        connection.request("GET", "/api/v1/benches/sim/live", headers=headers)
        yield connection.getresponse()
    finally:
        connection.close()


def _next(answer: http.client.HTTPResponse) -> str:
    """The name of the next event; '' where the answer is over."""
    while line := answer.readline().decode():
        if line.startswith("event:"):
            return line.removeprefix("event:").strip()
    return ""


def _last(answer: http.client.HTTPResponse) -> str:
    """The name of the last event of an answer that ends."""
    name = ""
    while following := _next(answer):
        name = following
    return name


def _as(service: Served, headers: dict[str, str], method: str = "GET", path: str = "/me") -> int:
    where = urlsplit(service.url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    try:
        connection.request(method, f"/api/v1{path}", headers=headers)
        return connection.getresponse().status
    finally:
        connection.close()
