"""How a notice reaches a recipient: by a signed post of JSON, or by mail."""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac
import json
import smtplib
import ssl
import time
import urllib.error
import urllib.request
from email.message import EmailMessage
from email.utils import format_datetime

from hil.core.errors import BadInputError, BenchError
from hil.core.errors.wording import printable
from hil.service.notices._notice import Notice
from hil.service.notices._settings import Mail, Recipient, Webhook

_WITHIN_S = 10.0
_PREFIX = "whsec_"


def send(notice: Notice, to: Recipient) -> None:
    """Send it once.

    Raises:
        BenchError: it was not taken; sending again may help.
        BadInputError: the secret is none.
    """
    if isinstance(to, Webhook):
        _post(notice, to)
    else:
        _mail(notice, to)


def signature(secret: str, id_: str, timestamp: int, body: bytes) -> str:
    """`v1,…` of https://www.standardwebhooks.com: HMAC-SHA256 of id, time in s and body, in base 64.

    Args:
        secret: 24 to 64 bytes in base 64, behind `whsec_`.

    Raises:
        BadInputError: the secret is not that.
    """
    try:
        key = base64.b64decode(secret.removeprefix(_PREFIX), validate=True)
    except binascii.Error as error:
        raise BadInputError(
            "the secret of a webhook is not base 64",
            where="secret_env",
            fix="make one: python -c \"import secrets, base64; print('whsec_' + "
            'base64.b64encode(secrets.token_bytes(32)).decode())"',
        ) from error
    signed = f"{id_}.{timestamp}.".encode() + body
    return f"v1,{base64.b64encode(hmac.new(key, signed, hashlib.sha256).digest()).decode()}"


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """A notice goes where the settings say, and nowhere else."""

    def redirect_request(self, *_: object) -> None:
        """None: the answer is an error."""


_OPENER = urllib.request.build_opener(_NoRedirect, urllib.request.ProxyHandler())


def _post(notice: Notice, to: Webhook) -> None:
    body = json.dumps(notice.as_json()).encode()
    at = int(time.time())
    headers = {"content-type": "application/json", "webhook-id": notice.id, "webhook-timestamp": str(at)}
    if to.secret:
        headers["webhook-signature"] = signature(to.secret, notice.id, at, body)
    request = urllib.request.Request(to.url, body, headers, method="POST")
    try:
        with _OPENER.open(request, timeout=_WITHIN_S):
            pass
    except urllib.error.HTTPError as error:
        with error:
            raise BenchError(f"the notice was answered with {error.code}", where=to.name) from error
    except (OSError, ValueError) as error:
        raise BenchError(f"the notice was not taken: {printable(error)}", where=to.name) from error


def _mail(notice: Notice, to: Mail) -> None:
    message = EmailMessage()
    message["Subject"] = " ".join(notice.subject.split())
    message["From"] = to.sender
    message["To"] = ", ".join(to.to)
    message["Date"] = format_datetime(notice.at)
    message["Message-ID"] = f"<{notice.id}.{int(notice.at.timestamp())}@{to.sender.partition('@')[2]}>"
    link = notice.data.get("url")
    message.set_content("\n\n".join(filter(None, (notice.subject, notice.text, link))) + "\n")
    try:
        with _server(to) as server:
            if to.user:
                server.login(to.user, to.password)
            server.send_message(message)
    except (OSError, smtplib.SMTPException) as error:
        where = f"{to.host}:{to.port}"
        raise BenchError(f"the mail was not taken: {printable(error)}", where=where) from error


def _server(to: Mail) -> smtplib.SMTP:
    context = ssl.create_default_context()
    if to.security == "tls":
        return smtplib.SMTP_SSL(to.host, to.port, timeout=_WITHIN_S, context=context)
    server = smtplib.SMTP(to.host, to.port, timeout=_WITHIN_S)
    if to.security == "starttls":
        server.starttls(context=context)
    return server
