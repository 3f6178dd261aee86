"""Requests for a stop as they come over the network, and answers, in one loop that never waits."""

from __future__ import annotations

import contextlib
import hashlib
import json
import logging
import re
import selectors
import socket
import time
import urllib.parse
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie

from hil.core.errors import StopWay
from hil.core.errors.wording import shortened
from hil.service.connection_limit import ConnectionLimit, descriptors
from hil.service.stop_post._messages import Owner

COOKIE = "hil_session"
#: A request is not longer: whatever is sent before its empty line.
LONGEST_BYTES = 8192
ALL = "/api/v1/emergency-stop"
_ONE = re.compile(r"/api/v1/benches/([A-Za-z0-9][A-Za-z0-9_.-]{0,63})/emergency-stop")


class RefusedError(Exception):
    """An answer that is no stop."""

    def __init__(self, status: HTTPStatus, what: str) -> None:
        super().__init__(what)
        self.status = status


@dataclass(frozen=True)
class Asked:
    """A stop that is asked for: of a bench, or of all; by whom, from where, how, when (s of the epoch)."""

    bench: str | None
    by: str
    role: str
    origin: str
    way: StopWay
    at_s: float


@dataclass
class Answering:
    """Reads requests.

    Attributes:
        hosts: names by which browsers may call; `*` for any.
        proxies: addresses of proxies, which say for whom they ask.
        owners: whose tokens and sessions are, by SHA-256.
    """

    hosts: frozenset[str]
    proxies: frozenset[str] = frozenset()
    owners: Mapping[str, Owner] = field(default_factory=dict)

    def asked(self, request: bytes, address: str) -> Asked | None:
        """What a whole head of a request asks for; None if it only asks whether this is the stop post.

        Raises:
            RefusedError: something else, or from the page of another site.
        """
        first, headers = _head(request)
        method, _, rest = first.partition(" ")
        path = rest.partition(" ")[0].partition("?")[0]
        self._refuse_other_sites(headers)
        one = _ONE.fullmatch(path)
        if one is None and path != ALL:
            raise RefusedError(HTTPStatus.NOT_FOUND, "this address accepts emergency stops only")
        if method in ("OPTIONS", "GET", "HEAD"):
            return None
        if method != "POST":
            raise RefusedError(HTTPStatus.METHOD_NOT_ALLOWED, "an emergency stop is a POST")
        if address in self.proxies:
            forwarded = headers.get("x-forwarded-for", address).rpartition(",")[2].strip()
            address = shortened(forwarded, 64) or address
        owner = self._owner(headers)
        by, role = (owner.name, owner.role) if owner is not None else (f"somebody at {address}", "")
        way: StopWay = "page" if "origin" in headers else "api"
        return Asked(one[1] if one else None, by, role, address, way, time.time())

    def allowed_origin(self, request: bytes) -> str:
        """The origin of a page that may read the answer; '' if there is none."""
        try:
            headers = _head(request)[1]
            self._refuse_other_sites(headers)
        except RefusedError:
            return ""
        return headers.get("origin", "")

    def _refuse_other_sites(self, headers: Mapping[str, str]) -> None:
        host = _name(f"//{headers.get('host', '')}")
        if "*" not in self.hosts and host not in self.hosts:
            raise RefusedError(HTTPStatus.MISDIRECTED_REQUEST, "unknown host name")
        if "origin" in headers and (_name(headers["origin"]) or None) not in self.hosts | {host}:
            raise RefusedError(HTTPStatus.FORBIDDEN, "the request comes from another site's page")

    def _owner(self, headers: Mapping[str, str]) -> Owner | None:
        """Who asks, if they say so and are known: no one is refused a stop."""
        header = headers.get("authorization", "")
        secret = header[7:].strip() if header.lower().startswith("bearer ") else ""
        if not secret:
            try:
                found = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
            except CookieError:
                found = None
            secret = found.value if found is not None else ""
        owner = self.owners.get(hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest())
        if owner is not None and owner.until_s is not None and owner.until_s < time.time():
            return None
        return owner


def answer(status: HTTPStatus, content: Mapping[str, object], origin: str) -> bytes:
    """An answer as it goes over the network; `origin` may read it."""
    body = json.dumps(content).encode()
    lines = [
        f"HTTP/1.1 {status.value} {status.phrase}",
        "Content-Type: application/json",
        f"Content-Length: {len(body)}",
        "Cache-Control: no-store",
        "Connection: close",
    ]
    if origin and origin.isascii() and origin.isprintable():
        lines += [
            f"Access-Control-Allow-Origin: {origin}",
            "Access-Control-Allow-Credentials: true",
            "Access-Control-Allow-Methods: POST",
            "Access-Control-Allow-Headers: authorization, content-type",
            "Vary: Origin",
        ]
    return "\r\n".join([*lines, "", ""]).encode() + body


def refusal(error: RefusedError) -> bytes:
    """What is answered to what is no stop."""
    return answer(error.status, {"what": str(error), "where": "", "fix": ""}, "")


def _head(request: bytes) -> tuple[str, dict[str, str]]:
    first, *lines = request.decode("latin-1").split("\r\n")
    pairs = (line.partition(":") for line in lines if line)
    return first, {name.strip().lower(): value.strip() for name, _, value in pairs}


def _name(url: str) -> str:
    try:
        return urllib.parse.urlsplit(url).hostname or ""
    except ValueError:
        return ""


#: A request has come whole by then; who sends a stop sends it in one piece.
_REQUEST_WITHIN_S = 5.0
_LAST_BYTES_S = 1.0
_MOST = 1024
#: So few that between them is read what has come: who sends a request is never pushed out by a burst.
_AT_ONCE = 4

logger = logging.getLogger(__name__)


@dataclass(eq=False)
class _Caller:
    socket: socket.socket
    address: str
    until_s: float
    head: bytearray = field(default_factory=bytearray)
    answered: bool = False


class Listener:
    """Takes connections, and answers each request by what `answer(head, address)` says.

    Args:
        listening: a socket that listens, non-blocking.
    """

    def __init__(
        self,
        selector: selectors.BaseSelector,
        listening: socket.socket,
        answer: Callable[[bytes, str], bytes],
    ) -> None:
        self._selector, self._listening, self._answer = selector, listening, answer
        self._callers: ConnectionLimit[_Caller] = ConnectionLimit(min(_MOST, descriptors() // 4))
        self._deadlines: dict[_Caller, None] = {}  # the earliest first, by kind nearly so
        selector.register(listening, selectors.EVENT_READ, self.accept)

    def accept(self) -> None:
        """Take who has come, some at a time."""
        for _ in range(_AT_ONCE):
            try:
                connection, place = self._listening.accept()
            except (BlockingIOError, ConnectionError, InterruptedError):
                return
            except OSError as error:  # no descriptor is left: the longest silent one gives its own
                logger.warning("no connection could be taken: %s", error)
                if not self._deadlines:
                    return
                self._close(next(iter(self._deadlines)))
                continue
            address = str(place[0]) if place else ""
            taken, gives_way = self._callers.give_way(address)
            if gives_way is not None:
                self._close(gives_way)
            if not taken:
                connection.close()
                continue
            connection.setblocking(False)
            self._add(_Caller(connection, address, time.monotonic() + _REQUEST_WITHIN_S))

    def close_late(self) -> None:
        """Close those whose time is over."""
        now_s = time.monotonic()
        for caller in [one for one in self._deadlines if one.until_s <= now_s]:
            self._close(caller)

    def _add(self, caller: _Caller) -> None:
        self._callers.add(caller, caller.address)
        self._deadlines[caller] = None
        self._selector.register(caller.socket, selectors.EVENT_READ, lambda: self._read(caller))
        self._read(caller)  # what has come already need not wait for its turn

    def _read(self, caller: _Caller) -> None:
        try:
            data = caller.socket.recv(LONGEST_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            data = b""
        if not data:
            self._close(caller)
            return
        if caller.answered:
            return  # a body that no one needs
        caller.head += data
        head, end, _ = bytes(caller.head).partition(b"\r\n\r\n")
        if end:
            self._finish(caller, head)
        elif len(caller.head) > LONGEST_BYTES:
            self._close(caller)

    def _finish(self, caller: _Caller, head: bytes) -> None:
        """Answer, and wait a little for the caller to have read it."""
        caller.answered, caller.until_s = True, time.monotonic() + _LAST_BYTES_S
        with contextlib.suppress(OSError):  # a caller that is gone wants no answer
            caller.socket.send(self._answer(head, caller.address))
            caller.socket.shutdown(socket.SHUT_WR)

    def _close(self, caller: _Caller) -> None:
        self._callers.remove(caller)
        self._deadlines.pop(caller, None)
        with contextlib.suppress(KeyError, ValueError):
            self._selector.unregister(caller.socket)
        caller.socket.close()
