"""Stamps of an adapter whose clock jumps: told once; nothing old is taken for news, nothing new for old."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drivers import Wire
from hil.core.can.frames import FrameBlock, frames
from hil.core.errors import BenchError
from tests.clocks import SteppedClock


class Adapter:
    """Gives a frame for each call, stamped a millisecond ago by a clock that somebody sets."""

    def __init__(self, clock: SteppedClock) -> None:
        self._clock, self.ahead_s, self.late_s = clock, 0.0, 0.001

    def recv_block(self) -> FrameBlock:
        return frames(0x100, np.zeros(1, np.uint64), 8, self._clock.now_s() - self.late_s + self.ahead_s)


def wire() -> tuple[Wire, Adapter, SteppedClock]:
    clock = SteppedClock()
    adapter = Adapter(clock)
    bus: Any = adapter
    return Wire("a", bus, clock), adapter, clock


def lag_s(one: Wire, clock: SteppedClock) -> float:
    clock.sleep_until(clock.now_s() + 0.01)
    return clock.now_s() - float(one.drain()["time_s"][-1])


@pytest.mark.parametrize("jump_s", [3600.0, -3600.0, 0.7, -7.0])
def test_a_jump_is_told_once_and_undone(jump_s: float) -> None:
    one, adapter, clock = wire()
    for _ in range(60):
        assert lag_s(one, clock) == pytest.approx(0.001)
    one.check()
    adapter.ahead_s = jump_s
    for _ in range(5):
        assert lag_s(one, clock) == pytest.approx(0.001)
    with pytest.raises(BenchError, match=f"the adapter's clock has jumped by {jump_s:.1f} s"):
        one.check()
    one.check()


def test_frames_that_are_late_or_an_own_pause_are_no_jump() -> None:
    one, adapter, clock = wire()
    assert lag_s(one, clock) == pytest.approx(0.001)
    for _ in range(60):
        lag_s(one, clock)
    for late_s in (0.4, 0.001, 2.0, 0.7, 0.0):  # held up, and in time again
        adapter.late_s = late_s
        assert lag_s(one, clock) == pytest.approx(late_s)
    clock.sleep_until(clock.now_s() + 2.0)  # no one looked meanwhile, and the oldest frames were kept
    adapter.late_s = 1.9
    assert lag_s(one, clock) == pytest.approx(1.9)
    one.check()


def test_an_adapter_whose_clock_drifts_has_not_jumped() -> None:
    one, adapter, clock = wire()
    for _ in range(1000):
        adapter.ahead_s += 1e-3  # a second in ten
        lag_s(one, clock)
    one.check()
