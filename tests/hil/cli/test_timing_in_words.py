"""The line about time at the end of a run."""

from __future__ import annotations

import pytest

from hil.cli.run_output import times_in_words, timing_in_words
from hil.core.result import Lateness, PeriodicRequests, Timing


@pytest.mark.parametrize(
    ("factor", "said"), [(0.2, "0.2"), (0.104, "0.1"), (1.0, "1"), (5.23, "5.2"), (34.2, "34")]
)
def test_what_is_slow_is_not_called_zero(factor: float, said: str) -> None:
    assert times_in_words(factor) == said


def test_a_bench_in_wall_clock_time_has_a_line_for_each_request() -> None:
    late = Lateness(p50_ms=0.05, p99_ms=0.4, max_ms=2.25)
    request = PeriodicRequests(
        request="torque request", device="RMCU", period_s=0.001, count=5000, missed=3, sent=late, seen=late
    )
    (line, pause) = timing_in_words(Timing(clock="wall", requests=(request,), pauses=1, longest_pause_s=0.3))
    assert line.startswith(
        "RMCU torque request: 5000 every 1 ms, sent p50 0.05 p99 0.4 largest 2.2 ms late; on the"
    )
    assert line.endswith("3 cycles missed, by the loop or while the machine stood still")
    assert pause == "the bench loop was delayed once, at most 0.3 s"


@pytest.mark.parametrize(
    ("unseen", "said"), [(0, "the adapter gives own frames not back"), (7, "none came back from the bus")]
)
def test_why_nothing_was_seen_on_the_bus_is_said(unseen: int, said: str) -> None:
    late = Lateness(p50_ms=0.05, p99_ms=0.4, max_ms=2.25)
    request = PeriodicRequests(
        request="heartbeat", device="dynos", period_s=0.05, count=7, missed=0, sent=late, unseen=unseen
    )
    (line,) = timing_in_words(Timing(clock="wall", requests=(request,)))
    assert f"on the bus not known ({said})" in line
    assert line.endswith("; 0 cycles missed"), "no one's doing"


def test_virtual_time_needs_none() -> None:
    assert list(timing_in_words(Timing(clock="virtual"))) == []
    assert list(timing_in_words(None)) == []
