"""Buckets as JSON, each written once: viewers choose channels and come at moments of their own."""

from __future__ import annotations

import math

from hil.service.live.live import Buckets

_DIGITS = 6  # to be drawn
_MOST = 8000  # buckets that are remembered before those that are gone are looked for


class BucketTexts:
    """Texts of the last minute's buckets, by channel."""

    def __init__(self, buckets: Buckets) -> None:
        self._buckets = buckets
        self._texts: dict[int, dict[str, tuple[str, str]]] = {}
        self._joined: dict[tuple[str, int], str] = {}  # from a bucket to the last
        self._last = -1

    def of(self, channel: str, first: int, last: int) -> str:
        """`"channel":{"lowest":[…],"highest":[…]}` of the buckets from one number to another, left out."""
        if last != self._last:
            self._last, self._joined = last, {}
        if (channel, first) not in self._joined:
            self._joined[channel, first] = self._join(channel, first, last)
        return self._joined[channel, first]

    def _join(self, channel: str, first: int, last: int) -> str:
        if len(self._texts) > _MOST:
            self._texts = {n: known for n, known in self._texts.items() if n >= self._buckets.oldest}
        pairs = [self._pair(channel, number) for number in range(first, last)]
        lowest, highest = (",".join(pair[end] for pair in pairs) for end in (0, 1))
        return f'"{channel}":{{"lowest":[{lowest}],"highest":[{highest}]}}'

    def _pair(self, channel: str, number: int) -> tuple[str, str]:
        known = self._texts.setdefault(number, {})
        if channel not in known:
            column = self._buckets.names.index(channel)
            low, high = self._buckets.bucket(number)
            known[channel] = _text(float(low[column])), _text(float(high[column]))
        return known[channel]


def _text(value: float) -> str:
    return repr(float(f"{value:.{_DIGITS}g}")) if math.isfinite(value) else "null"
