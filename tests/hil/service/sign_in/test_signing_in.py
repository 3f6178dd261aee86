"""The real service and a real provider: who gets in, who does not, and what is written down."""

from __future__ import annotations

import http.client
import os
import urllib.parse
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from hil.service.serving import make_token
from tests.hil.service.served import RefusedError, Served, environment_of, served
from tests.hil.service.sign_in.conftest import SECRET_ENV
from tests.hil.service.sign_in.provider import AnyProvider, provider

pytestmark = pytest.mark.slow
_RETURN = "/api/v1/sign-in/return"


@pytest.fixture(scope="module")
def identities() -> Iterator[AnyProvider]:
    with provider() as one:
        yield one


@pytest.fixture(scope="module")
def there(identities: AnyProvider, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("sign-in")
    token = make_token(
        folder / "data", environment_of(folder / "data")["HIL_DATABASE"], "root", "admin"
    ).secret
    with served_with(folder, identities.url, token) as one:
        yield one


def served_with(folder: Path, issuer: str, token: str = "", *more: str):
    settings = folder / "sign-in.toml"
    settings.write_text(
        f'name = "Lab"\nissuer = "{issuer}"\nclient_id = "bench"\nclient_secret_env = "{SECRET_ENV}"\n'
        f'address = "http://127.0.0.1:8080"\n[roles]\nlab = "operator"\nchiefs = "admin"\nguests = "viewer"\n'
    )
    state = folder / "state"
    return served(folder / "data", "--sign-in", str(settings), *more, state=state, token=token)


@dataclass
class Browser:
    """Cookies of one, and what it is answered."""

    service: Served
    cookies: dict[str, str] = field(default_factory=dict)
    set_cookies: list[str] = field(default_factory=list)

    def ask(self, method: str, path: str, **headers: str) -> tuple[int, str]:
        """Status and the place that it is sent to."""
        where = urlsplit(self.service.url)
        connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=60)
        sent = {"cookie": "; ".join(f"{name}={value}" for name, value in self.cookies.items())} | headers
        try:
            connection.request(method, path, headers=sent)
            answer = connection.getresponse()
            answer.read()
            self.set_cookies = answer.headers.get_all("set-cookie") or []
            for cookie in self.set_cookies:
                name, _, value = cookie.partition(";")[0].partition("=")
                self.cookies[name] = value.strip('"')
            return answer.status, answer.headers.get("location", "")
        finally:
            connection.close()

    def begin(self, place: str = "/") -> str:
        status, url = self.ask("GET", f"/api/v1/sign-in?place={urllib.parse.quote(place)}")
        assert status == 303
        return url

    def come_back(self, answer: dict[str, str]) -> str:
        status, place = self.ask("GET", f"{_RETURN}?{urllib.parse.urlencode(answer)}")
        assert status == 303
        return place

    def sign_in(self, identities: AnyProvider, subject: str, place: str = "/") -> str:
        return self.come_back(identities.answer(self.begin(place), subject))

    def me(self) -> int:
        return self.ask("GET", "/api/v1/me")[0]


def test_somebody_signs_in_and_out(there: Served, identities: AnyProvider) -> None:
    identities.add("in-and-out", name="Anna Berg", groups=["others", "lab"])
    browser = Browser(there)
    assert browser.me() == 401
    assert browser.sign_in(identities, "in-and-out", "/runs?plan=short") == "/runs?plan=short"
    [session] = [one for one in browser.set_cookies if one.startswith("hil_session=")]
    assert all(one in session.lower() for one in ("httponly", "samesite=strict", "max-age=43200"))
    assert browser.me() == 200
    [person] = [one for one in there.get("/people") if one["subject"] == "in-and-out"]
    assert (person["name"], person["role"]) == ("Anna Berg", "operator")
    [row] = [one for one in there.get("/audit") if one["action"] == "sign in" and one["who"] == "Anna Berg"]
    assert f"subject in-and-out of {identities.url}, by group lab" in row["detail"]
    assert browser.ask("GET", "/api/v1/tokens")[0] == 403
    foreign = {"origin": "https://elsewhere.example"}
    assert browser.ask("DELETE", "/api/v1/session", **foreign)[0] == 403
    assert browser.ask("DELETE", "/api/v1/session", **{"sec-fetch-site": "cross-site"})[0] == 403
    session_of = dict(browser.cookies)
    assert browser.ask("DELETE", "/api/v1/session")[0] == 204
    assert Browser(there, session_of).me() == 401


def test_an_answer_counts_once_and_in_its_own_browser(there: Served, identities: AnyProvider) -> None:
    identities.add("once", name="Once", groups=["lab"])
    browser, other = Browser(there), Browser(there)
    answer = identities.answer(browser.begin(), "once")
    other.begin()
    assert other.come_back(answer) == "/?sign_in=late"
    assert browser.come_back(answer) == "/?sign_in=late"  # it was tried, and is over by that
    kept = dict(browser.cookies)
    answer = identities.answer(browser.begin(), "once")
    kept |= browser.cookies
    assert browser.come_back(answer) == "/"
    assert Browser(there, kept).come_back(answer) == "/?sign_in=late"
    assert Browser(there).come_back({"code": "x", "state": "y"}) == "/?sign_in=late"
    assert Browser(there).come_back({}) == "/?sign_in=late"


def test_a_code_that_the_provider_did_not_give_and_a_refusal_open_nothing(
    there: Served, identities: AnyProvider
) -> None:
    browser = Browser(there)
    state = dict(urllib.parse.parse_qsl(urlsplit(browser.begin()).query))["state"]
    assert browser.come_back({"code": "guessed", "state": state}) == "/?sign_in=token"
    assert browser.come_back(identities.answer(browser.begin(), "") | {"state": ""}) == "/?sign_in=late"
    state = dict(urllib.parse.parse_qsl(urlsplit(browser.begin()).query))["state"]
    assert browser.come_back({"error": "access_denied", "state": state}) == "/?sign_in=declined"
    assert "hil_session" not in browser.cookies


def test_a_person_without_a_known_group_is_not_let_in(there: Served, identities: AnyProvider) -> None:
    identities.add("guest", name="A guest", groups=["others"])
    browser = Browser(there)
    assert browser.sign_in(identities, "guest") == "/?sign_in=no_role"
    assert browser.me() == 401
    [row] = [one for one in there.get("/audit") if one["who"] == "A guest (guest)"]
    assert (row["action"], row["role"]) == ("sign in refused", "")


def test_groups_are_judged_anew_at_the_next_sign_in(there: Served, identities: AnyProvider) -> None:
    identities.add("moving", name="Moving", groups=["chiefs"])
    early, late = Browser(there), Browser(there)
    early.sign_in(identities, "moving")
    assert early.ask("GET", "/api/v1/tokens")[0] == 200
    identities.add("moving", name="Moving", groups=["guests"])
    late.sign_in(identities, "moving")
    assert early.ask("GET", "/api/v1/tokens")[0] == 403
    assert early.me() == 200
    identities.add("moving", name="Moving", groups=[])
    assert late.sign_in(identities, "moving") == "/?sign_in=no_role"
    assert (early.me(), late.me()) == (401, 401)


def test_an_administrator_signs_somebody_out(there: Served, identities: AnyProvider) -> None:
    identities.add("leaving", name="Leaving", groups=["lab"])
    browser = Browser(there)
    browser.sign_in(identities, "leaving")
    [person] = [one for one in there.get("/people") if one["subject"] == "leaving"]
    there.ask("DELETE", f"/api/v1/people/{person['id']}/sessions")
    assert browser.me() == 401


def test_without_tokens_nobody_is_let_in_who_has_not_signed_in(
    identities: AnyProvider, tmp_path: Path
) -> None:
    identities.add("chief", name="Chief", groups=["chiefs"])
    log = tmp_path / "serve.log"
    with served_with(tmp_path, identities.url, "", "--log", str(log)) as service:
        with pytest.raises(RefusedError) as refused:
            service.get("/benches")
        assert refused.value.status == 401
        assert service.ask("GET", "/api/v1/health")["sign_in"] == "Lab"
        browser = Browser(service)
        browser.sign_in(identities, "chief")
        assert browser.ask("GET", "/api/v1/audit")[0] == 200
        answer = identities.answer(browser.begin(), "chief")
        browser.come_back(answer | {"code": "guessed"})
    kept = log.read_text()
    assert "a sign-in is refused" in kept
    secrets = [os.environ[SECRET_ENV], *answer.values(), *browser.cookies.values()]
    assert [one for one in secrets if len(one) > 2 and one in kept] == []


def test_a_service_without_the_setting_has_no_sign_in(service: Served) -> None:
    assert service.ask("GET", "/api/v1/health")["sign_in"] == ""
    for path in ("/sign-in", "/sign-in/return"):
        with pytest.raises(RefusedError) as refused:
            service.get(path)
        assert refused.value.status == 404
