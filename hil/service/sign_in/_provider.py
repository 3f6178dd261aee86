"""An OpenID provider: its discovery document, its keys, and the ID tokens that it signs.

By authlib and joserfc: OpenID Connect Core 1.0, section 3.1 (authorization code flow), Discovery 1.0, and
RFC 7636 (PKCE). All of it waits for the network: it is called in a thread.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from typing import Any

import requests
from authlib.integrations.base_client import OAuthError
from authlib.integrations.requests_client import OAuth2Session
from authlib.oidc.core import CodeIDToken
from joserfc import jwt
from joserfc.errors import InvalidKeyIdError, JoseError
from joserfc.jwk import KeySet

from hil.core.errors.wording import printable
from hil.service.sign_in._settings import SignInSettings, is_safe
from hil.service.sign_in._tried import SignInError, Tried

WITHIN_S = 10.0
#: Clocks of two machines differ by less.
_LEEWAY_S = 60
_DISCOVERED_AGAIN_S = 3600.0
_KEYS_AGAIN_S = 30.0
#: Signatures that only the provider can make: with a shared secret the client could, too.
_ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA")
_ENDPOINTS = ("authorization_endpoint", "token_endpoint", "jwks_uri")


class Provider:
    """The provider of the settings; what it publishes is kept for an hour."""

    def __init__(self, settings: SignInSettings) -> None:
        self._settings = settings
        self._lock = threading.Lock()
        self._found: Mapping[str, Any] = {}
        self._found_s = -_DISCOVERED_AGAIN_S
        self._keys: KeySet | None = None
        self._keys_s = -_KEYS_AGAIN_S

    def authorization_url(self, tried: Tried) -> str:
        """Where the browser is sent.

        Raises:
            SignInError: the provider does not answer as one.
        """
        found = self._discovered()
        with self._client(found) as client:
            url, _ = client.create_authorization_url(
                found["authorization_endpoint"],
                state=tried.state,
                code_verifier=tried.verifier,
                nonce=tried.nonce,
            )
        return str(url)

    def claims(self, code: str, tried: Tried) -> Mapping[str, Any]:
        """What the provider vouches for of the person with this code.

        Raises:
            SignInError: the code or the ID token is not valid, or the provider does not answer as one.
        """
        found = self._discovered()
        try:
            with self._client(found) as client:
                answer = client.fetch_token(
                    found["token_endpoint"],
                    grant_type="authorization_code",
                    code=code,
                    code_verifier=tried.verifier,
                    timeout=WITHIN_S,
                    allow_redirects=False,
                )
        except OAuthError as error:
            raise SignInError("token", f"the code was refused: {printable(str(error.error), 100)}") from None
        except (requests.RequestException, ValueError) as error:
            raise SignInError("provider", f"its token endpoint fails: {type(error).__name__}") from None
        token = answer.get("id_token")
        if not isinstance(token, str):
            raise SignInError("token", "the answer has no ID token")
        return self.verified(token, tried.nonce, str(answer.get("access_token", "")))

    def verified(self, token: str, nonce: str, access_token: str = "") -> Mapping[str, Any]:
        """The claims of an ID token: its signature, issuer, audience, times and nonce are right.

        Raises:
            SignInError: one of them is not, or the provider does not answer as one.
        """
        decoded = self._decoded(token)
        options = {
            "iss": {"essential": True, "value": self._settings.issuer},
            "aud": {"essential": True, "value": self._settings.client_id},
        }
        of_request = {"nonce": nonce, "client_id": self._settings.client_id, "access_token": access_token}
        claims = CodeIDToken(decoded.claims, decoded.header, options, of_request)
        try:
            claims.validate(leeway=_LEEWAY_S)
        except JoseError as error:
            raise SignInError("token", f"the ID token is refused: {printable(str(error), 200)}") from None
        subject = claims["sub"]
        if not isinstance(subject, str) or not 1 <= len(subject) <= 255 or not subject.isprintable():
            raise SignInError("token", "the ID token is refused: sub is no text of 1 to 255 characters")
        return dict(claims)

    def _decoded(self, token: str) -> jwt.Token:
        known = self._discovered().get("id_token_signing_alg_values_supported", ["RS256"])
        allowed = [one for one in _ALGORITHMS if one in known]
        try:
            try:
                return jwt.decode(token, self._key_set(fresh=False), algorithms=allowed)
            except InvalidKeyIdError:  # the provider may have changed its keys
                return jwt.decode(token, self._key_set(fresh=True), algorithms=allowed)
        except (JoseError, ValueError) as error:
            raise SignInError("token", f"the ID token is refused: {printable(str(error), 200)}") from None

    def _client(self, found: Mapping[str, Any]) -> OAuth2Session:
        settings = self._settings
        methods = found.get("token_endpoint_auth_methods_supported") or ["client_secret_basic"]
        by_secret = "client_secret_basic" if "client_secret_basic" in methods else "client_secret_post"
        return OAuth2Session(
            settings.client_id,
            settings.secret or None,
            token_endpoint_auth_method=by_secret if settings.secret else "none",
            scope=" ".join(settings.scopes),
            redirect_uri=settings.return_url,
            code_challenge_method="S256",
        )

    def _discovered(self) -> Mapping[str, Any]:
        with self._lock:
            if time.monotonic() - self._found_s > _DISCOVERED_AGAIN_S:
                url = f"{self._settings.issuer.rstrip('/')}/.well-known/openid-configuration"
                self._found = self._checked(_got(url))
                self._found_s = time.monotonic()
            return self._found

    def _checked(self, found: Mapping[str, Any]) -> Mapping[str, Any]:
        issuer = found.get("issuer")
        if issuer != self._settings.issuer:
            words = f"it calls itself {printable(str(issuer), 200)}, the settings {self._settings.issuer}"
            raise SignInError("provider", words)
        for name in _ENDPOINTS:
            if not is_safe(str(found.get(name, ""))):
                raise SignInError("provider", f"its {name} is missing, or neither TLS nor this machine")
        return found

    def _key_set(self, *, fresh: bool) -> KeySet:
        url = self._discovered()["jwks_uri"]
        with self._lock:
            age_s = time.monotonic() - self._keys_s
            if self._keys is None or age_s > _DISCOVERED_AGAIN_S or (fresh and age_s > _KEYS_AGAIN_S):
                try:
                    self._keys = KeySet.import_key_set(_got(url))
                except (JoseError, ValueError, KeyError, TypeError) as error:
                    raise SignInError(
                        "provider", f"its keys cannot be read: {type(error).__name__}"
                    ) from None
                self._keys_s = time.monotonic()
            return self._keys


def _got(url: str) -> Any:
    """A JSON object that the provider publishes.

    Raises:
        SignInError: it does not.
    """
    try:
        answer = requests.get(url, timeout=WITHIN_S, allow_redirects=False)
        found = answer.json() if answer.status_code == requests.codes.ok else None
    except (requests.RequestException, ValueError) as error:
        raise SignInError("provider", f"{url} cannot be read: {type(error).__name__}") from None
    if not isinstance(found, dict):
        raise SignInError("provider", f"{url} gives no JSON object (status {answer.status_code})")
    return found
