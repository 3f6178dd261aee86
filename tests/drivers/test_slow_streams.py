"""Sources of other rates beside the time base: what was measured stands once, and nothing is made up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from drivers import SampleAssembler, SampleQueue, Samples, Stream

BASE = Stream("status", "bus 'b'", ("motor_speed_rad_s",), ("rad/s",), 1e-3, late_s=0.003)
SLOW = Stream("reading", "device 'd'", ("oil_temperature_k", "oil_pressure_pa"), ("K", "Pa"), 0.05)
FAST = Stream("memory", "device 'x'", ("current_a",), ("A",), 1e-4)


def of(stream: Stream, times: np.ndarray, columns: int = 1) -> Samples:
    return Samples(stream, times, np.column_stack([np.arange(len(times), dtype=float)] * columns))


def assemble(other: Samples, base: np.ndarray, chunks: int = 1) -> tuple[SampleAssembler, np.ndarray]:
    assembler = SampleAssembler([BASE, other.stream], 1e-3)
    rows = []
    for part in range(chunks):
        now = base[(part + 1) * len(base) // chunks - 1]
        before = base[part * len(base) // chunks - 1] if part else -np.inf
        for whole in (of(BASE, base), other):
            new = (whole.time_s > before) & (whole.time_s <= now)
            assembler.add(Samples(whole.stream, whole.time_s[new], whole.values[new]))
        rows.append(assembler.rows(everything=part == chunks - 1))
    return assembler, np.concatenate(rows)


@example(period_s=0.14453125, begin_s=0.0, chunks=9, n=3)  # just behind the last row of a part
@given(
    period_s=st.floats(0.0016, 0.3),
    begin_s=st.floats(0.0, 0.05),
    chunks=st.integers(1, 9),
    n=st.integers(1, 40),
)
def test_each_sample_stands_once_in_the_row_nearest_to_it(
    period_s: float, begin_s: float, chunks: int, n: int
) -> None:
    base = 3.0 + np.arange(400) * 1e-3
    times = 3.0 + begin_s + np.arange(n) * period_s
    stream = Stream("reading", "device 'd'", SLOW.channels, SLOW.units, period_s)
    assembler, rows = assemble(of(stream, times, 2), base, chunks)
    column = rows[:, assembler.names.index("oil_temperature_k")]
    there = np.flatnonzero(~np.isnan(column))
    seen = times[times <= base[-1]]
    np.testing.assert_array_equal(column[there], np.arange(len(seen)))
    np.testing.assert_array_less(np.abs(base[there] - seen), 0.5e-3 + 1e-9)
    np.testing.assert_array_equal(column, rows[:, assembler.names.index("oil_pressure_pa")])
    assert assembler.late == 0


def test_the_time_base_does_not_wait_for_a_slow_device() -> None:
    assembler = SampleAssembler([BASE, SLOW], 1e-3)
    assembler.add(of(BASE, np.arange(100) * 1e-3))
    assert len(assembler.rows()) == pytest.approx(100 - 1e3 * SLOW.late_s, abs=1)


def test_what_comes_after_its_row_is_left_out_and_counted() -> None:
    assembler = SampleAssembler([BASE, SLOW], 1e-3)
    base = of(BASE, np.arange(200) * 1e-3)
    assembler.add(Samples(BASE, base.time_s[:100], base.values[:100]))
    written = len(assembler.rows())
    assembler.add(of(SLOW, np.array([0.010, 0.150]), 2))
    assembler.add(Samples(BASE, base.time_s[100:], base.values[100:]))
    rows = assembler.rows(everything=True)
    assert np.flatnonzero(~np.isnan(rows[:, 2])).tolist() == [150 - written]
    assert assembler.late == 1


def test_of_a_faster_device_each_row_has_the_sample_nearest_to_it() -> None:
    base = np.arange(50) * 1e-3
    _, rows = assemble(of(FAST, np.arange(500) * 1e-4), base, chunks=3)
    np.testing.assert_array_equal(rows[:, 2], 10 * np.arange(50))


def test_a_queue_hands_out_each_sample_once() -> None:
    queue = SampleQueue(SLOW)
    queue.put(SLOW, 1.5, 300.0, 2e5)
    (samples,) = queue.samples()
    assert (samples.stream, samples.time_s.tolist(), samples.values.tolist()) == (SLOW, [1.5], [[300.0, 2e5]])
    assert queue.samples() == []
