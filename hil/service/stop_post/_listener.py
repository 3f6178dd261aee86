"""Connections of those who want a stop: read, answered and closed from one loop that never waits for any."""

from __future__ import annotations

import contextlib
import logging
import selectors
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from hil.service.connection_limit import ConnectionLimit, descriptors
from hil.service.stop_post._answering import LONGEST_BYTES

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
