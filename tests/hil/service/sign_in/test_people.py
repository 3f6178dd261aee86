"""People in the store: a name is one person's, a role is that of the last sign-in."""

from __future__ import annotations

from sqlalchemy import Engine

from hil.service.store import PersonStore, TokenStore

_ISSUER = "https://id.example.org"


def test_a_session_follows_the_role_of_the_newest_sign_in(engine: Engine) -> None:
    people = PersonStore(engine)
    anna, first = people.sign_in(_ISSUER, "u-1", "Anna Berg", "engineer", 12.0)
    assert people.of_session(first) == anna
    again, second = people.sign_in(_ISSUER, "u-1", "Anna Berg", "viewer", 12.0)
    assert (again.id, again.name, again.role) == (anna.id, "Anna Berg", "viewer")
    assert people.of_session(first).role == people.of_session(second).role == "viewer"
    assert {one.role for one in people.owners().values()} == {"viewer"}
    people.close_session(first)
    assert (people.of_session(first), people.of_session(second)) == (None, again)
    people.refuse(_ISSUER, "u-1")
    assert people.of_session(second) is None
    assert people.owners() == {}
    assert [one.name for one in people.all()] == ["Anna Berg"]


def test_no_one_acts_under_the_name_of_another(engine: Engine) -> None:
    people, tokens = PersonStore(engine), TokenStore(engine)
    tokens.make("bert", "engineer", 1.0)
    tokens.make("Östen", "engineer", 1.0)
    assert people.sign_in(_ISSUER, "u-9", "Östen", "viewer", 12.0)[0].name == "Östen (u-9)"
    anna, _ = people.sign_in(_ISSUER, "u-1", "Anna Berg", "engineer", 12.0)
    second, _ = people.sign_in(_ISSUER, "u-2", "anna berg", "engineer", 12.0)
    elsewhere, _ = people.sign_in("https://other.example.org", "u-1", "Anna Berg", "engineer", 12.0)
    bert, _ = people.sign_in(_ISSUER, "u-3", "bert", "engineer", 12.0)
    assert anna.name == "Anna Berg"
    assert second.name == "anna berg (u-2)"
    assert elsewhere.name == "Anna Berg (u-1)"
    assert bert.name == "bert (u-3)"
    assert people.sign_in(_ISSUER, "u-2", "anna berg", "engineer", 12.0)[0].name == second.name
    assert people.sign_in(_ISSUER, "u-1", "Anna Alm", "engineer", 12.0)[0].name == "Anna Berg"
    pair = [people.sign_in(_ISSUER, "s" * 250 + end, "Anna Berg", "viewer", 12.0)[0].name for end in "ab"]
    assert len(set(pair)) == 2
    assert max(map(len, pair)) <= 100


def test_a_session_ends_by_itself_or_with_all_of_a_person(engine: Engine) -> None:
    people = PersonStore(engine)
    anna, short = people.sign_in(_ISSUER, "u-1", "Anna Berg", "viewer", -1e-6)
    assert people.of_session(short) is None
    _, long = people.sign_in(_ISSUER, "u-1", "Anna Berg", "viewer", 1.0)
    assert people.close_all(anna.id) is not None
    assert people.of_session(long) is None
    assert people.close_all(anna.id + 1) is None
