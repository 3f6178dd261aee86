"""What is done again and again, and less often while a network does not answer."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable

from hil.service.archive._archive import ArchiveAwayError
from hil.service.store import DatabaseAwayError

_LOOK_S = 2.0
_LONGEST_S = 60.0  # between two tries while the store is away

logger = logging.getLogger(__name__)


class Rounds:
    """Goes round until it is cancelled; `problem` is what kept the last round from its work, '' if nothing.

    Args:
        once: goes round; what keeps a part of the work from being done, '' if nothing does.
        what: whose, as the log has it.
    """

    def __init__(self, once: Callable[[], Awaitable[str]], what: str) -> None:
        self._once, self._what = once, what
        self.problem = ""
        self.count = 0

    async def work(self) -> None:
        """Go round."""
        wait_s = _LOOK_S
        while True:
            try:
                text = await self._once()
            except (ArchiveAwayError, DatabaseAwayError) as error:
                text = str(error)
            wait_s = min(2.0 * wait_s, _LONGEST_S) if text else _LOOK_S
            if text and text != self.problem:
                logger.warning("%s wait: %s", self._what, text)
            elif self.problem and not text:
                logger.warning("%s are kept again", self._what)
            self.problem = text
            self.count += 1
            await asyncio.sleep(wait_s)
