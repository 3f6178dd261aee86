"""An OpenID provider on this machine: oidc-provider-mock, a process of its own, which also insists on PKCE.

Beside what it has, it refuses a code whose verifier does not hash to the challenge (RFC 7636): the package
leaves that out.
"""

from __future__ import annotations

import base64
import contextlib
import datetime
import hashlib
import json
import os
import re
import subprocess
import sys
import urllib.parse
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class AnyProvider:
    """One that answers at `url`."""

    url: str

    def add(self, subject: str, **claims: object) -> None:
        """Somebody who can sign in there, or what the provider says of them from now on."""
        request = urllib.request.Request(
            f"{self.url}/users/{urllib.parse.quote(subject)}",
            json.dumps(claims).encode(),
            {"content-type": "application/json"},
            method="PUT",
        )
        with urllib.request.urlopen(request, timeout=30):
            pass

    def answer(self, authorization_url: str, subject: str) -> dict[str, str]:
        """What comes back to the client when somebody signs in: `code` and `state`, or `error`."""
        form = {"action": "deny"} if not subject else {"sub": subject}
        request = urllib.request.Request(authorization_url, urllib.parse.urlencode(form).encode())
        try:
            with _OPENER.open(request, timeout=30) as answer:
                place = str(answer.headers["location"])
        except urllib.error.HTTPError as redirect:
            with redirect:
                place = str(redirect.headers["location"])
        return dict(urllib.parse.parse_qsl(urllib.parse.urlsplit(place).query))


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: object) -> None:
        """None: the answer is what is wanted."""


_OPENER = urllib.request.build_opener(_NoRedirect)


@contextlib.contextmanager
def provider(*, valid_s: int = 3600) -> Iterator[AnyProvider]:
    """Begin one whose tokens are valid so long, and end it."""
    command = [sys.executable, "-W", "ignore", "-m", __name__, str(valid_s)]
    environment = {**os.environ, "AUTHLIB_INSECURE_TRANSPORT": "1"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    try:
        yield AnyProvider(process.stdout.readline().strip())
    finally:
        process.terminate()
        process.wait(30)
        process.stdout.close()


def main() -> None:
    """Answer until it is ended."""
    import flask
    import oidc_provider_mock
    import werkzeug.serving

    app = oidc_provider_mock.app(
        require_nonce=True, access_token_max_age=datetime.timedelta(seconds=int(sys.argv[1]))
    )
    challenges: dict[str, str] = {}

    @app.after_request
    def keep_challenge(response: flask.Response) -> flask.Response:
        location = urllib.parse.urlsplit(response.headers.get("location", ""))
        code = dict(urllib.parse.parse_qsl(location.query)).get("code")
        if flask.request.path == "/oauth2/authorize" and code:
            assert flask.request.args["code_challenge_method"] == "S256"
            challenges[code] = flask.request.args["code_challenge"]
        return response

    @app.get("/favicon.ico")
    def icon() -> tuple[str, int]:
        return "", 204

    @app.after_request
    def leave_out_what_is_elsewhere(response: flask.Response) -> flask.Response:
        if response.mimetype == "text/html":  # its style would come from another network
            response.set_data(
                re.sub(r"<(link|script)[^>]*https://[^>]*>", "", response.get_data(as_text=True))
            )
        return response

    @app.before_request
    def refuse_other_verifier() -> tuple[dict[str, str], int] | None:
        if flask.request.path != "/oauth2/token":
            return None
        digest = hashlib.sha256(flask.request.form["code_verifier"].encode()).digest()
        challenge = base64.urlsafe_b64encode(digest).decode().rstrip("=")
        if challenges.get(flask.request.form["code"]) == challenge:
            return None
        return {"error": "invalid_grant"}, 400

    server = werkzeug.serving.make_server("127.0.0.1", 0, app, threaded=True)
    print(f"http://127.0.0.1:{server.server_port}", flush=True)
    server.serve_forever()


if __name__ == "__main__":
    main()
