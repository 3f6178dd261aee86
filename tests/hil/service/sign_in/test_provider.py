"""What an ID token has to be, against a provider that signs real ones."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

from hil.service.sign_in._provider import Provider
from hil.service.sign_in._settings import SignInSettings
from hil.service.sign_in._tried import SignInError, Tried
from tests.hil.service.sign_in.conftest import SECRET_ENV
from tests.hil.service.sign_in.provider import AnyProvider, provider


@pytest.fixture(scope="module")
def there() -> Iterator[AnyProvider]:
    with provider() as one:
        one.add("u-1", name="Anna Berg", groups=["lab"])
        yield one


def _settings(issuer: str, client: str = "bench") -> SignInSettings:
    return SignInSettings(
        name="Lab",
        issuer=issuer,
        client_id=client,
        client_secret_env=SECRET_ENV,
        address="http://127.0.0.1:8080",
        roles={"lab": "viewer"},
    )


def _tried() -> Tried:
    return Tried(place="/", until_s=time.monotonic() + 60.0)


def _code(there: AnyProvider, client: Provider, tried: Tried) -> str:
    answer = there.answer(client.authorization_url(tried), "u-1")
    assert answer["state"] == tried.state
    return answer["code"]


def _reason(refused: pytest.ExceptionInfo[SignInError], *words: str) -> str:
    assert all(one in str(refused.value) for one in words), refused.value
    return refused.value.reason


def test_a_code_gives_the_claims_once(there: AnyProvider) -> None:
    client, tried = Provider(_settings(there.url)), _tried()
    code = _code(there, client, tried)
    claims = client.claims(code, tried)
    assert (claims["sub"], claims["name"], claims["groups"]) == ("u-1", "Anna Berg", ["lab"])
    with pytest.raises(SignInError) as refused:
        client.claims(code, tried)
    assert _reason(refused, "invalid_grant") == "token"


def test_a_code_of_another_verifier_is_refused(there: AnyProvider) -> None:
    client, tried = Provider(_settings(there.url)), _tried()
    code = _code(there, client, tried)
    with pytest.raises(SignInError) as refused:
        client.claims(code, replace(tried, verifier=_tried().verifier))
    assert _reason(refused, "invalid_grant") == "token"


def test_a_token_of_another_sign_in_is_refused_by_its_nonce(there: AnyProvider) -> None:
    client, tried = Provider(_settings(there.url)), _tried()
    code = _code(there, client, tried)
    with pytest.raises(SignInError) as refused:
        client.claims(code, replace(tried, nonce=_tried().nonce))
    assert _reason(refused, "nonce") == "token"


def test_a_token_for_another_audience_is_refused(there: AnyProvider) -> None:
    client, other, tried = Provider(_settings(there.url)), Provider(_settings(there.url, "other")), _tried()
    token = _id_token(other, _code(there, other, tried), tried)
    assert other.verified(token, tried.nonce)["aud"] == ["other"]
    with pytest.raises(SignInError) as refused:
        client.verified(token, tried.nonce)
    assert _reason(refused, "aud") == "token"


def test_a_token_of_another_issuer_is_refused(there: AnyProvider) -> None:
    here = there.url.replace("127.0.0.1", "localhost")  # it calls itself as it is called
    client, other, tried = Provider(_settings(there.url)), Provider(_settings(here)), _tried()
    token = _id_token(other, _code(there, other, tried), tried)
    with pytest.raises(SignInError) as refused:
        client.verified(token, tried.nonce)
    assert _reason(refused, "iss") == "token"


def test_a_provider_that_calls_itself_otherwise_is_refused(there: AnyProvider) -> None:
    with pytest.raises(SignInError) as refused:
        Provider(_settings(f"{there.url}/")).authorization_url(_tried())
    assert _reason(refused, "calls itself", there.url) == "provider"


def test_a_token_signed_by_another_provider_is_refused(there: AnyProvider) -> None:
    with provider() as second:
        second.add("u-1", name="Anna Berg", groups=["lab"])
        other, tried = Provider(_settings(second.url)), _tried()
        token = _id_token(other, _code(second, other, tried), tried)
    with pytest.raises(SignInError) as refused:
        Provider(_settings(there.url)).verified(token, tried.nonce)
    assert _reason(refused, "refused") == "token"


def test_a_token_that_was_changed_is_refused(there: AnyProvider) -> None:
    client, tried = Provider(_settings(there.url)), _tried()
    head, body, signature = _id_token(client, _code(there, client, tried), tried).split(".")
    unsigned = "eyJhbGciOiJub25lIn0"  # {"alg":"none"}
    for token in (f"{unsigned}.{body}.", f"{head}.{body[:-2]}AA.{signature}", "a.b.c", ""):
        with pytest.raises(SignInError) as refused:
            client.verified(token, tried.nonce)
        assert refused.value.reason == "token"


def test_a_token_that_has_expired_is_refused() -> None:
    with provider(valid_s=-120) as expired:
        expired.add("u-1", name="Anna Berg", groups=["lab"])
        client, tried = Provider(_settings(expired.url)), _tried()
        with pytest.raises(SignInError) as refused:
            client.claims(_code(expired, client, tried), tried)
    assert _reason(refused, "expired") == "token"


def test_a_provider_that_is_not_there_is_named() -> None:
    with pytest.raises(SignInError) as refused:
        Provider(_settings("http://127.0.0.1:9")).authorization_url(_tried())
    assert _reason(refused, "http://127.0.0.1:9/.well-known/openid-configuration") == "provider"


def _id_token(client: Provider, code: str, tried: Tried) -> str:
    found = client._discovered()
    with client._client(found) as session:
        answer = session.fetch_token(
            found["token_endpoint"],
            grant_type="authorization_code",
            code=code,
            code_verifier=tried.verifier,
        )
    return str(answer["id_token"])
