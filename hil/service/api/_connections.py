"""Connections to the API: bounded in number and in how long a request may take to come."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from hil.service.connection_limit import ConnectionLimit, descriptors

#: A request's head, and the whole of it with its body, have come by then.
HEAD_WITHIN_S = 10.0
WHOLE_WITHIN_S = 60.0
_MOST = 1000
_MOST_OF_ONE = 400  # fifty pages with all their connections


def bounded(proxies: frozenset[str]) -> type[asyncio.Protocol]:
    """The protocol of a server whose connections are one crowd; `proxies` may hold all of it.

    Half of the descriptors stay for runs, files and the database, however many connect.
    """
    most = min(_MOST, descriptors() // 2)
    crowd: ConnectionLimit[_Bounded] = ConnectionLimit(
        most, min(_MOST_OF_ONE, max(1, 3 * most // 4)), proxies
    )

    class Protocol(_Bounded):
        def __init__(self, *arguments: Any, **named: Any) -> None:
            super().__init__(*arguments, **named)
            self._crowd = crowd

    return Protocol


class _Bounded(H11Protocol):
    """A connection that is closed if its request does not come, or if it has to give way."""

    _crowd: ConnectionLimit[_Bounded]
    _deadline: asyncio.TimerHandle | None = None
    _in_request = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take it, if need be in the place of one that has been silent."""
        super().connection_made(transport)
        address = self.client[0] if self.client else ""
        taken, gives_way = self._crowd.give_way(address)
        if gives_way is not None:
            gives_way.transport.abort()
            self._crowd.remove(gives_way)
        if not taken:
            transport.abort()
            return
        self._crowd.add(self, address)
        self._wait(HEAD_WITHIN_S)

    def connection_lost(self, exc: Exception | None) -> None:
        """It is closed."""
        self._crowd.remove(self)
        self._wait(None)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Look whether the request is whole."""
        super().data_received(data)
        self._look()

    def on_response_complete(self) -> None:
        """The next request may come: until then it is silent."""
        super().on_response_complete()
        self._in_request = False
        self._look()

    def _look(self) -> None:
        cycle = self.cycle
        answering = cycle is not None and not cycle.response_complete
        if answering and not cycle.more_body:
            self._crowd.heard(self)
            self._wait(None)
            self._in_request = False
        elif answering and not self._in_request:
            self._in_request = True
            self._wait(WHOLE_WITHIN_S)
        elif not answering and self._deadline is None:
            self._crowd.silent(self)
            self._wait(HEAD_WITHIN_S)

    def _wait(self, for_s: float | None) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
        self._deadline = None if for_s is None else self.loop.call_later(for_s, self._give_up)

    def _give_up(self) -> None:
        """Its time is over; what it has sent until now is nothing."""
        self.transport.abort()
