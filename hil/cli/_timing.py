"""How a run kept its time, in words for the end of a command."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.result import Lateness, Timing


def times_in_words(factor: float) -> str:
    """A real-time factor: 34, 5.2, 0.2; never 0 for what is only slow."""
    return f"{factor:.0f}" if factor >= 10 else f"{factor:.2g}"


def timing_in_words(timing: Timing | None) -> Iterator[str]:
    """A line for each periodic request of a bench in wall-clock time; nothing in virtual time."""
    if timing is None or timing.clock == "virtual":
        return
    for request in timing.requests:
        seen = _late(request.seen) if request.seen else f"not known ({request.why_not_seen})"
        yield (
            f"{request.device} {request.request}: {request.count} every {request.period_s * 1e3:g} ms, sent "
            f"{_late(request.sent)}; on the bus {seen}; {request.missed_in_words}"
        )
    if timing.pauses:
        times = "once" if timing.pauses == 1 else f"{timing.pauses} times"
        yield f"the bench loop was delayed {times}, at most {timing.longest_pause_s:g} s"


def _late(late: Lateness) -> str:
    return f"p50 {late.p50_ms:.2g} p99 {late.p99_ms:.2g} largest {late.max_ms:.2g} ms late"
