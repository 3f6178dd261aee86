"""Encodes what many viewers get once, and keeps it for the next."""

from __future__ import annotations

from collections.abc import Callable, Hashable


class BroadcastCache:
    """The newest text of each kind that viewers were sent."""

    def __init__(self) -> None:
        self._newest: dict[str, tuple[object, str]] = {}

    def text(self, kind: str, of: Hashable, make: Callable[[], str]) -> str:
        """What was stated of it, or what `make` says."""
        known, text = self._newest.get(kind, (None, ""))
        if known != of:
            text = make()
            self._newest[kind] = of, text
        return text
