"""The service that an agent works for, or the first of several with one database that answers."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import TypeVar

from hil.client import Client, RefusedError
from hil.core.errors import BenchError
from hil.execution.background import apart

T = TypeVar("T")
_LATER = (408, 429, 500, 502, 503, 504)

logger = logging.getLogger(__name__)


class AwayError(BenchError):
    """The service does not answer now, or cannot do what it is asked."""


class TheService:
    """Asks in threads, so that a network that hangs holds up nothing here.

    Args:
        urls: services of one database; the next is asked when one does not answer.

    Attributes:
        away: why there was no answer the last time; '' if there was.
        answers: how often there was one.
    """

    def __init__(self, urls: Sequence[str], token: str) -> None:
        self._clients = [Client(url, token) for url in urls]
        self._urls, self._at = list(urls), 0
        self.away = ""
        self.answers = 0

    @property
    def url(self) -> str:
        """Of the one that is asked."""
        return self._urls[self._at]

    async def ask(self, question: Callable[[Client], T]) -> T:
        """The answer.

        Raises:
            AwayError: none now.
            RefusedError: it will not be given.
        """
        asked = self._at
        try:
            answer = await apart(lambda: question(self._clients[asked]))
        except RefusedError as error:
            if error.status in _LATER:
                raise AwayError(error.what, where=error.where) from error
            raise
        except BenchError as error:
            self._lost(asked, error)
            if asked == self._at:
                self._at = (asked + 1) % len(self._clients)
            raise AwayError(error.what, where=error.where) from error
        if self.away:
            logger.warning("the service answers again: %s", self.url)
        self.away = ""
        self.answers += 1
        return answer

    def _lost(self, asked: int, error: BenchError) -> None:
        if not self.away:
            logger.warning("the service is away: %s: %s", self._urls[asked], error.what)
        self.away = error.what
