"""Samples that came and wait to be handed out, and how many of them never came."""

from __future__ import annotations

from drivers.samples import Samples, Stream

_LOOK_S, _LEAST_SAMPLES = 0.5, 20


class Measured:
    """A `SampleSource`; `lost`: the share of samples that never came, over the last half second or so."""

    def __init__(self, stream: Stream) -> None:
        self.streams = (stream,)
        self._look_s = max(_LOOK_S, _LEAST_SAMPLES * stream.period_s)
        self._waiting: list[Samples] = []
        self.begin(0.0)

    @property
    def came(self) -> bool:
        """Whether anything came since `begin`."""
        return self._newest is not None

    def begin(self, now_s: float) -> None:
        """Forget what came until now, and count from here."""
        self._waiting.clear()
        self.lost = 0.0
        self._since_s, self._came = now_s, 0
        self._first: int | None = None
        self._newest: int | None = None

    def take(self, samples: Samples, now_s: float) -> None:
        """Samples with counts have come."""
        if samples.counts is None or not len(samples.counts):
            return
        self._waiting.append(samples)
        if self._first is None:
            self._first = int(samples.counts[0]) - 1
        self._newest = max(self._newest or self._first, int(samples.counts.max()))
        self._came += len(samples.counts)
        if now_s - self._since_s >= self._look_s:
            wanted = self._newest - self._first
            self.lost = max(0.0, 1.0 - self._came / wanted) if wanted > 0 else 0.0
            self._since_s, self._first, self._came = now_s, self._newest, 0

    def samples(self) -> list[Samples]:
        """What has come since the last call."""
        waiting, self._waiting = self._waiting, []
        return waiting
