"""Whose tokens and sessions are, kept in memory: a stop says who asked for it, and asks no database."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import time
from collections.abc import Callable, Iterable, Mapping

from hil.execution.background import apart
from hil.service.stop_post import Owner, StopPost
from hil.service.store import DatabaseAwayError, PersonStore, TokenStore

_LOOK_S = 2.0  # another process may make and revoke tokens, too


class OwnersKnown:
    """What the database had last of tokens and sessions; its stop post knows the same."""

    def __init__(self, stores: Iterable[TokenStore | PersonStore], stop_post: StopPost | None) -> None:
        self._stores, self._stop_post = tuple(stores), stop_post
        self._known: Mapping[str, Owner] = {}
        self._changed = asyncio.Event()
        with contextlib.suppress(DatabaseAwayError):
            self._take(self._asked())

    def of(self, secret: str) -> Owner | None:
        """Whose a secret is; None if it is no one's, or its time is over."""
        found = self._known.get(hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest())
        over = found is not None and found.until_s is not None and found.until_s < time.time()
        return None if over else found

    def any(self) -> bool:
        """Whether there is a token or session that is not revoked."""
        return bool(self._known)

    def changed(self) -> None:
        """Ask the database now."""
        self._changed.set()

    async def follow(self, closing: Callable[[], bool]) -> None:
        """Ask the database from time to time, apart from the loop."""
        while not closing():
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._changed.wait(), _LOOK_S)
            self._changed.clear()
            with contextlib.suppress(DatabaseAwayError):
                self._take(await apart(self._asked))

    def _asked(self) -> dict[str, Owner]:
        return {secret: owner for store in self._stores for secret, owner in store.owners().items()}

    def _take(self, owners: Mapping[str, Owner]) -> None:
        self._known = owners
        if self._stop_post is not None:
            self._stop_post.know_owners(owners)
