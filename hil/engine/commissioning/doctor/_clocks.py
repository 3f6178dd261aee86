"""How the devices' clocks go against this machine's, from what they send by themselves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from drivers import TICK_S, Finding, SampleAssembler, Samples, SampleSource, Stream
from hil.core.errors import BenchError
from hil.core.result import StreamClock

_RATE_WITHIN = 0.05  # share by which samples may come more often or more seldom than they should
_LATE_S = 0.02  # the RMCU waits 50 ms for the host


class Listener:
    """Takes the samples of every source, counts them and fits their clocks."""

    def __init__(self, sources: Sequence[SampleSource]) -> None:
        self._sources = sources
        self._streams = [stream for source in sources for stream in source.streams]
        self._taken: list[Samples] = []
        self._counts = dict.fromkeys(self._streams, 0)

    def take(self) -> None:
        """What has come since the last call."""
        for source in self._sources:
            for samples in source.samples():
                self._counts[samples.stream] += len(samples.time_s)
                self._taken.append(samples)

    def forget(self) -> None:
        """Let go of what has come until now."""
        for source in self._sources:
            list(source.samples())

    def clocks(self) -> tuple[list[StreamClock], list[Finding]]:
        """The clock of each counted stream that came; the first is what the others are compared with."""
        present = [stream for stream in self._streams if self._counts[stream]]
        if not present:
            return [], []
        assembler = SampleAssembler(list(_with_counters(present)), TICK_S)
        for samples in self._taken:
            assembler.add(samples)
        assembler.rows(everything=True)
        found = [
            StreamClock(
                stream=timing.stream.label,
                where=timing.stream.where,
                counted_by=timing.stream.counting.by if timing.stream.counting else "its own frames",
                offset_s=round(timing.offset_s, 6) + 0.0,
                drift_ppm=round(timing.drift_ppm, 1) + 0.0,
                latest_s=round(timing.latest_s, 6),
                lost=timing.lost,
                left_out=timing.left_out,
            )
            for timing in assembler.timings()
        ]
        return found, [*_parted(assembler), *_late(found)]

    def means(self) -> dict[str, float]:
        """Mean of each channel that came, where every value is known."""
        found: dict[str, float] = {}
        for stream in self._streams:
            values = [samples.values for samples in self._taken if samples.stream is stream]
            if values:
                means = np.concatenate(values).mean(axis=0)
                found |= dict(zip(stream.channels, means.tolist(), strict=True))
        return {name: mean for name, mean in found.items() if np.isfinite(mean)}

    def findings_of_rates(self, duration_s: float) -> Iterator[Finding]:
        """Streams that come more often or more seldom than they should."""
        for stream, count in self._counts.items():
            expected = duration_s / stream.period_s
            if count and abs(count - expected) > max(2.0, _RATE_WITHIN * expected):
                what = (
                    f"{stream.label} comes {count / duration_s:.4g} times a second, "
                    f"{1 / stream.period_s:.4g} are expected"
                )
                fix = "check the device's cycle time, the load of the bus, and whether frames are lost"
                yield Finding("fault", what, stream.where, fix)


def _with_counters(streams: Iterable[Stream]) -> Iterator[Stream]:
    """The streams, and what counts them, each once."""
    seen: set[Stream] = set()
    for stream in streams:
        counter = stream.counting.follows if stream.counting else None
        for one in (stream, *([counter] if counter else [])):
            if one not in seen:
                seen.add(one)
                yield one


def _parted(assembler: SampleAssembler) -> Iterator[Finding]:
    try:
        assembler.look_for_parted_clocks()
    except BenchError as error:
        yield Finding.of(error)


def _late(clocks: Iterable[StreamClock]) -> Iterator[Finding]:
    for clock in clocks:
        if clock.lost:
            fix = "check the adapter's receive buffer and the load of this machine"
            yield Finding("fault", f"{clock.lost} samples of {clock.stream} are lost", clock.where, fix)
        if clock.latest_s > _LATE_S:
            what = f"{clock.stream} arrived up to {clock.latest_s * 1e3:.0f} ms late"
            fix = "close other programs, use another USB port; see docs/explanation/time.md"
            yield Finding("hint", what, clock.where, fix)
