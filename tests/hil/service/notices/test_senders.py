"""What arrives at a webhook and at a mail server."""

from __future__ import annotations

import base64
import email
import email.policy
import hashlib
import hmac
import json

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.service.notices._notice import of_stop
from hil.service.notices._senders import send, signature
from hil.service.notices._settings import Mail, Webhook
from tests.hil.service.notices.receivers import Mails, Posts, listening

_NOTICE = of_stop("rig", "pressed by the door switch", "https://bench.example.org/")


def test_a_webhook_gets_signed_json(monkeypatch: pytest.MonkeyPatch) -> None:
    key = bytes(range(32))
    monkeypatch.setenv("HOOK", "whsec_" + base64.b64encode(key).decode())
    with listening(Posts()) as server:
        send(_NOTICE, Webhook(url=server.url, secret_env="HOOK"))
    headers, body = server.got[0]
    signed = f"{headers['webhook-id']}.{headers['webhook-timestamp']}.".encode() + body
    expected = base64.b64encode(hmac.new(key, signed, hashlib.sha256).digest()).decode()
    assert headers["webhook-signature"] == f"v1,{expected}"
    content = json.loads(body)
    assert content["type"] == "bench_stopped"
    assert content["data"]["bench"] == "rig"
    assert content["data"]["url"] == "https://bench.example.org/benches/rig"


def test_the_signature_is_that_of_the_standard() -> None:
    """The example of the specification of Standard Webhooks, https://www.standardwebhooks.com."""
    secret = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"
    body = b'{"test": 2432232314}'
    found = signature(secret, "msg_p5jXN8AQM9LWM0D4loKWxJek", 1614265330, body)
    assert found == "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE="


@pytest.mark.parametrize("status", [302, 400, 500])
def test_an_answer_that_is_no_success_is_an_error(status: int) -> None:
    with listening(Posts()) as server:
        server.status = status
        with pytest.raises(BenchError, match=str(status)):
            send(_NOTICE, Webhook(url=server.url))
    assert len(server.got) == 1


def test_who_does_not_answer_is_an_error() -> None:
    with pytest.raises(BenchError, match="was not taken"):
        send(_NOTICE, Webhook(url="http://127.0.0.1:9/"))
    with pytest.raises(BenchError, match="was not taken"):
        send(_NOTICE, Mail(host="127.0.0.1", port=9, sender="a@b", to=("c@d",)))


def test_a_secret_that_is_none_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOOK", "no base 64!")
    with pytest.raises(BadInputError, match="base 64"):
        send(_NOTICE, Webhook(url="http://127.0.0.1:9/", secret_env="HOOK"))


def test_mail_has_subject_text_and_link() -> None:
    with listening(Mails()) as server:
        to = Mail(
            host="127.0.0.1",
            port=server.port,
            security="none",
            sender="bench@b.org",
            to=("x@y.org", "z@y.org"),
        )
        send(_NOTICE, to)
    recipients, text = server.got[0]
    assert recipients == ["x@y.org", "z@y.org"]
    message = email.message_from_string(text, policy=email.policy.default)
    assert message["subject"] == "rig: emergency stop"
    assert message["message-id"]
    assert message["date"]
    content = message.get_content()
    assert "pressed by the door switch" in content
    assert "https://bench.example.org/benches/rig" in content
