"""What every request passes first: names, origins, sizes and rates; and headers that every answer has."""

from __future__ import annotations

import asyncio
import json
import logging
import re
import time
from collections import OrderedDict
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hil.api_schemas.agent import MOST_PIECE_BYTES
from hil.service.store import in_turns

MOST_BODY_BYTES = 256_000
#: A piece of a file may be longer, of a run's that an agent sends or of a recording: MOST_PIECE_BYTES.
_PIECE = re.compile(r"/api/v1/(agents/[0-9a-f]{32}/runs/[0-9]+/files/[^/]+|recordings/[0-9]+/content)")
_EMERGENCY = "/emergency-stop"
_PLAIN_NAME = re.compile(r"[A-Za-z0-9.:-]{1,255}")
_MOST_ADDRESSES = 10_000
_SAFE = ("GET", "HEAD", "OPTIONS")
_OTHER_SITES = ("cross-site", "same-site")
_POLICY = (
    "default-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'; "
    "frame-ancestors 'none'; form-action 'self'"
)

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Rates:
    """Requests that an address may send, a second and at once."""

    a_second: float
    at_once: float


@dataclass(frozen=True)
class StopAddress:
    """Where the stop post is: at this port of the service's host, or at a URL of its own."""

    port: int = 0
    url: str = ""

    def seen_from(self, host: str) -> str:
        """Its URL for who calls the service by this `Host`; '' if there is none."""
        name = _name(host)
        if self.url or not self.port or not _PLAIN_NAME.fullmatch(name):
            return self.url
        return f"http://[{name}]:{self.port}" if ":" in name else f"http://{name}:{self.port}"


@dataclass(frozen=True)
class Guarding:
    """What requests have to be.

    Attributes:
        hosts: names by which browsers may call the service; `*` for any.
        rates: of requests that one address may send.
        stop: where the stop post is, to which its page may send, too.
        proxies: addresses of trusted proxies.
    """

    hosts: tuple[str, ...]
    rates: Rates
    stop: StopAddress = StopAddress()
    proxies: frozenset[str] = frozenset()


class Guard:
    """Wraps the application. An emergency stop is never refused for its rate."""

    def __init__(self, app: ASGIApp, guarding: Guarding) -> None:
        self._app, self._hosts, self._rates = app, guarding.hosts, guarding.rates
        self._stop = guarding.stop
        self._spent: OrderedDict[str, tuple[float, float]] = OrderedDict()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refusal = self._refusal(scope, headers)
        if refusal is not None:
            await _refuse(send, *refusal)
            return
        limited = _Limited(receive, _most(scope)).receive
        sending = _with_headers(send, self._stop.seen_from(headers.get("host", "")))
        begun = False

        async def noted(message: Message) -> None:
            nonlocal begun
            begun = True
            await sending(message)

        try:
            await in_turns(self._answered(scope, limited, noted))
        except asyncio.CancelledError:  # the server does not wait longer: that is no error of ours
            logger.info("%s %s was not answered: the service ends", scope["method"], scope["path"])
            if not begun:
                await _refuse(send, 503, "the service ends", "ask again when it is up")

    async def _answered(self, scope: Scope, receive: Receive, send: Send) -> None:
        await self._app(scope, receive, send)

    def _refusal(self, scope: Scope, headers: Headers) -> tuple[int, str] | None:
        host = headers.get("host", "")
        if "*" not in self._hosts and _name(host) not in self._hosts:
            return 421, "unknown host name; start the service with --allow-host NAME"
        origin = headers.get("origin")
        if origin is not None and scope["method"] not in _SAFE and urlsplit(origin).netloc != host:
            return 403, "the request comes from another site's page"
        if headers.get("sec-fetch-site") in _OTHER_SITES and scope["method"] not in _SAFE:
            return 403, "the request comes from another site's page"
        if not _fits(headers.get("content-length", "0"), _most(scope)):
            return 413, f"at most {_most(scope)} bytes are accepted"
        client = scope.get("client")
        if not scope["path"].endswith(_EMERGENCY) and not self._may(client[0] if client else ""):
            return 429, "too many requests; wait a second"
        return None

    def _may(self, address: str) -> bool:
        """Whether an address has not sent too many; counts the request."""
        now_s = time.monotonic()
        spent, at_s = self._spent.pop(address, (0.0, now_s))
        spent = max(0.0, spent - (now_s - at_s) * self._rates.a_second)
        may = spent + 1.0 <= self._rates.at_once
        self._spent[address] = (spent + may, now_s)
        while len(self._spent) > _MOST_ADDRESSES:
            self._spent.popitem(last=False)
        return may


class _Limited:
    """A body that ends where it becomes too long: its size may not be known beforehand."""

    def __init__(self, receive: Receive, most: int) -> None:
        self._receive, self._left = receive, most

    async def receive(self) -> Message:
        message = await self._receive()
        self._left -= len(message.get("body", b""))
        return message if self._left >= 0 else {"type": "http.disconnect"}


def _name(host: str) -> str:
    """The name of a Host header, without its port."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def _most(scope: Scope) -> int:
    return MOST_PIECE_BYTES if _PIECE.fullmatch(scope["path"]) else MOST_BODY_BYTES


def _fits(length: str, most: int) -> bool:
    return length.isascii() and length.isdecimal() and int(length[:12]) <= most


async def _refuse(send: Send, status: int, what: str, fix: str = "") -> None:
    body = json.dumps({"what": what, "where": "", "fix": fix}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    if status == 429:
        headers.append((b"retry-after", b"1"))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def _with_headers(send: Send, stop: str) -> Send:
    policy = f"{_POLICY}; connect-src 'self' {stop}" if stop else _POLICY

    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers.setdefault("content-security-policy", policy)
            headers.setdefault("cache-control", "no-store")
            headers["x-content-type-options"] = "nosniff"
            headers["referrer-policy"] = "no-referrer"
        await send(message)

    return sending
