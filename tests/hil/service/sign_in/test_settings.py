"""The file that says where people sign in: every mistake at once, with its line."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.service.sign_in import SignInSettings, local_place, read_settings
from hil.service.sign_in._sign_in import _groups, _name
from tests.hil.service.sign_in.conftest import SECRET_ENV

GOOD = f"""
name = "Laboratory account"
issuer = "https://id.example.org/realms/lab"
client_id = "bench"
client_secret_env = "{SECRET_ENV}"
address = "https://bench.example.org/"

[roles]
bench-people = "operator"
"bench admins" = "admin"
"""


def _read(tmp_path: Path, text: str) -> SignInSettings:
    path = tmp_path / "sign-in.toml"
    path.write_text(text)
    return read_settings(path)


def test_the_highest_role_of_the_groups_counts(tmp_path: Path) -> None:
    settings = _read(tmp_path, GOOD)
    assert settings.return_url == "https://bench.example.org/api/v1/sign-in/return"
    assert settings.role_of(["others", "bench-people"]) == ("operator", "bench-people")
    assert settings.role_of(["bench admins", "bench-people"]) == ("admin", "bench admins")
    assert settings.role_of(["others"]) is None
    assert settings.role_of([]) is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("https://id", "http://id"), "line 3: issuer"),
        (("https://bench.example.org/", "https://bench.example.org/page"), "must have no path"),
        (('client_id = "bench"', ""), "client_id: is missing"),
        (("client_id", "client_ids"), "did you mean 'client_id'?"),
        ((f'"{SECRET_ENV}"', '"NO_SUCH_SECRET"'), "line 5: client_secret_env"),
        (('"operator"', '"agent"'), "line 9: roles.bench-people"),
        (('bench-people = "operator"\n"bench admins" = "admin"', ""), "must have at least 1"),
        (("\n[roles]", 'scopes = ["profile"]\nsession_hours = 25\n[roles]'), "'openid' among them"),
        (("\n[roles]", 'scopes = ["profile"]\nsession_hours = 25\n[roles]'), "at most 24"),
    ],
)
def test_a_mistake_is_named_with_its_line(tmp_path: Path, change: tuple[str, str], words: str) -> None:
    with pytest.raises(BadInputError) as refused:
        _read(tmp_path, GOOD.replace(*change))
    assert words in str(refused.value).replace("sign-in.toml, line 3: issuer", "line 3: issuer")


def test_all_mistakes_are_named_at_once(tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as refused:
        _read(
            tmp_path, GOOD.replace("https://id", "http://id").replace('"admin"', '"boss"') + 'x = "viewers"'
        )
    shown = str(refused.value)
    assert "3 mistakes" in shown
    assert all(one in shown for one in ("line 3: issuer", "line 10: roles.bench admins", "line 11: roles.x"))
    assert "docs/how-to/sign-in.md" in shown


@given(st.text(max_size=200))
def test_any_text_is_bad_input(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("any") / "sign-in.toml"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    with pytest.raises(BadInputError):
        read_settings(path)


@pytest.mark.parametrize(
    ("claims", "groups"),
    [
        ({"groups": ["a", 7, "b"]}, ["a", "b"]),
        ({"groups": "a"}, ["a"]),
        ({"groups": {"a": "b"}}, []),
        ({}, []),
        ({"groups": None}, []),
    ],
)
def test_groups_are_texts(claims: dict[str, object], groups: list[str]) -> None:
    assert _groups(claims, "groups") == groups


def test_a_dot_leads_into_an_object() -> None:
    claims = {"realm_access": {"roles": ["a"]}, "https://example.org/groups": ["b"]}
    assert _groups(claims, "realm_access.roles") == ["a"]
    assert _groups(claims, "https://example.org/groups") == ["b"]
    assert _groups(claims, "realm_access.roles.more") == []


def test_a_name_is_printable_and_on_one_line() -> None:
    assert _name({"sub": "7", "name": " Anna\n\u202eBerg\t"}, "name") == "Anna Berg"
    assert _name({"sub": "7", "name": " \n"}, "name") == "7"
    assert _name({"sub": "7", "preferred_username": "anna"}, "name") == "anna"
    assert len(_name({"sub": "7", "name": "x" * 1000}, "name")) == 100


@pytest.mark.parametrize(
    "place",
    ["https://elsewhere.example", "//elsewhere.example", "/\\elsewhere", "x", "", "/api/v1/me", "/a\nb"],
)
def test_no_place_leads_elsewhere(place: str) -> None:
    assert local_place(place) == "/"


def test_a_place_of_the_page_is_kept() -> None:
    assert local_place("/compare?runs=1,2") == "/compare?runs=1,2"
