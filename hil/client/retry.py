"""A service that does not answer for a while may be started again, or its network come back."""

from __future__ import annotations

import time
from collections.abc import Callable

from hil.client import RefusedError
from hil.core.errors import BenchError

#: What the service refuses because of what was asked, and would refuse again.
OURS = (400, 401, 403, 404, 413, 421, 422)
_GONE_S = 60.0


class Retry:
    """Asks a service again and again, and bears with it for a minute."""

    def __init__(self) -> None:
        self._heard_s = time.monotonic()

    def ask(self, question: Callable[[], None]) -> None:
        """Ask once; no answer is borne with.

        Raises:
            RefusedError: it refuses what was asked.
            BenchError: it has not answered for a minute.
        """
        try:
            question()
            self._heard_s = time.monotonic()
        except RefusedError as error:
            if error.status in OURS:
                raise
        except BenchError:
            if time.monotonic() - self._heard_s > _GONE_S:
                raise
