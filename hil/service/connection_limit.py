"""Which connection gives way when there are too many: one rule for the API and for the stop post.

A connection counts as silent while its request has not come whole. Of the address that holds most, the one
that has been silent longest gives way to a new one; so half-open connections push out each other, and who
sends a request at once is always heard. A connection whose request is being answered never gives way.
"""

from __future__ import annotations

import contextlib
import resource
from collections import Counter
from typing import Generic, TypeVar

C = TypeVar("C")

_UNLIMITED = 1 << 20


class ConnectionLimit(Generic[C]):
    """Connections by the address that they come from.

    Args:
        most: of all addresses together.
        most_of_one: of one address; None for no bound but `most`.
        unbounded: addresses that may hold all, as a proxy before the service does.
    """

    def __init__(self, most: int, most_of_one: int | None = None, unbounded: frozenset[str] = frozenset()):
        self._most, self._most_of_one, self._unbounded = most, most_of_one or most, unbounded
        self._all: dict[C, str] = {}
        self._silent: dict[C, str] = {}  # the longest first
        self._of: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._all)

    def give_way(self, address: str) -> tuple[bool, C | None]:
        """Whether a new one of an address is taken, and which one has to be closed for it."""
        if self._of[address] >= self._most_of_one and address not in self._unbounded:
            found = self._longest_silent(address)
            return found is not None, found
        if len(self._all) < self._most:
            return True, None
        for crowded, _ in self._of.most_common():
            found = self._longest_silent(crowded)
            if found is not None:
                return True, found
        return False, None

    def add(self, connection: C, address: str) -> None:
        """One more, silent until now."""
        self._all[connection] = address
        self._silent[connection] = address
        self._of[address] += 1

    def remove(self, connection: C) -> None:
        """It is closed."""
        address = self._all.pop(connection, None)
        self._silent.pop(connection, None)
        if address is not None:
            self._of[address] -= 1
            if not self._of[address]:
                del self._of[address]

    def heard(self, connection: C) -> None:
        """Its request has come whole."""
        self._silent.pop(connection, None)

    def silent(self, connection: C) -> None:
        """It is to send a request, from now on."""
        if connection in self._all:
            self._silent.pop(connection, None)
            self._silent[connection] = self._all[connection]

    def _longest_silent(self, address: str) -> C | None:
        return next((one for one, of in self._silent.items() if of == address), None)


def descriptors() -> int:
    """How many descriptors this process may have open."""
    soft = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return _UNLIMITED if soft == resource.RLIM_INFINITY else min(soft, _UNLIMITED)


def allow_all_descriptors() -> None:
    """Have as many descriptors as the system allows this process."""
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
