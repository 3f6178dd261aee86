"""Persistence, hysteresis, slopes: what reaches a range and what leaves it again."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers import Samples, Stream
from hil.engine.bench.range_scan import StreamRanges
from hil.engine.bench.ranges import Range

STREAM = Stream("status", "bus 'x'", ("value",), ("K",), 0.01)
values = st.lists(
    st.one_of(st.floats(-20, 20), st.just(math.nan), st.just(math.inf)), min_size=1, max_size=120
)
ranges = st.builds(
    lambda low, width, share, samples: Range(
        "value", low, low + width, 0.0, "r", "K", samples, share * width, "warn"
    ),
    st.floats(-10, 5),
    st.floats(0.1, 10),
    st.floats(0, 0.45),
    st.integers(0, 8),
)


def looked(range_: Range, readings: list[float], cut: int) -> tuple[StreamRanges, list[int]]:
    """Feeds readings in blocks of `cut`; the sample counts after which it was answered."""
    watched, answered = StreamRanges(STREAM, [range_]), []
    for first in range(0, len(readings), cut):
        block = np.array(readings[first : first + cut])[:, None]
        if watched.look(Samples(STREAM, np.zeros(len(block)), block)):
            answered += [first + len(block) for _ in watched.reached()]
    return watched, answered


def is_beyond(range_: Range, value: float) -> bool:
    return not range_.below <= value <= range_.above or not math.isfinite(value)


@given(ranges, values, st.integers(1, 20))
def test_never_more_than_its_persistence_passes(range_: Range, readings: list[float], cut: int) -> None:
    watched, _ = looked(range_, readings, cut)
    longest = run = 0
    for value in readings:
        run = run + 1 if is_beyond(range_, value) else 0
        longest = max(longest, run)
    if longest > range_.samples(STREAM.period_s):
        assert next(watched.results()).reached >= 1


@given(ranges, values)
def test_nothing_is_reached_by_values_inside(range_: Range, readings: list[float]) -> None:
    inside = [min(max(v, range_.below), range_.above) if math.isfinite(v) else range_.above for v in readings]
    watched, answered = looked(range_, inside, 10)
    assert (next(watched.results()).reached, answered) == (0, [])


@given(ranges, values, st.integers(1, 20))
def test_hysteresis_never_chatters(range_: Range, readings: list[float], cut: int) -> None:
    """Between two times that it is reached the value was inside by the hysteresis."""
    watched, answered = looked(range_, readings, cut)
    well, spells = True, 0
    for value in readings:
        if is_beyond(range_, value):
            spells += well
            well = False
        elif range_.below + range_.hysteresis <= value <= range_.above - range_.hysteresis:
            well = True
    assert len(answered) <= next(watched.results()).reached <= spells


@given(ranges, values, st.integers(1, 20), st.integers(1, 20))
def test_how_samples_come_in_blocks_changes_nothing(
    range_: Range, readings: list[float], one: int, other: int
) -> None:
    results = [next(looked(range_, readings, cut)[0].results()) for cut in (one, other)]
    assert results[0] == results[1]


@pytest.mark.parametrize(
    ("readings", "times"),
    [
        ([12.0] * 9, 1),  # stands: once
        ([12.0, 9.5] * 9, 1),  # between the limit and its hysteresis: still the same time
        ([12.0, 12.0, 8.0] * 3, 3),  # well inside in between: again
        ([12.0, 8.0] * 9, 0),  # one sample each: its persistence is one
        ([math.nan, math.nan], 1),
    ],
)
def test_once_for_each_time_that_it_is_reached(readings: list[float], times: int) -> None:
    range_ = Range("value", -math.inf, 10.0, 0.0, "r", "K", 1, 1.0, "warn")
    watched, answered = looked(range_, readings, 1)
    assert (len(answered), next(watched.results()).reached) == (times, times)


def ramp(slope: float) -> list[float]:
    return [slope * 0.01 * k for k in range(40)]


def test_a_slope_is_limited_in_units_a_second() -> None:
    range_ = Range("value", -50.0, 50.0, 0.05, "r", "", None, 0.0, "warn", slope_s=0.05)
    assert looked(range_, ramp(49.0), 7)[1] == []
    watched, answered = looked(range_, ramp(-51.0), 7)
    assert len(answered) == 1
    result = next(watched.results())
    assert (result.of, result.unit, result.lowest) == ("slope", "K/s", pytest.approx(-51.0))


@pytest.mark.parametrize(
    ("over_s", "taken_s"),
    [(0.001, 0.01), (0.01, 0.01), (0.03, 0.03), (0.06, 0.06), (0.07, 0.07), (0.29, 0.29)],
)
def test_a_slope_is_taken_over_its_time_in_whole_samples_at_least_one(over_s: float, taken_s: float) -> None:
    range_ = Range("value", -1e6, 1e6, 0.0, "r", "", None, 0.0, "warn", slope_s=over_s)
    watched, _ = looked(range_, [0.0] * 40 + [1.0] * 40, 7)
    assert next(watched.results()).highest == pytest.approx(1.0 / taken_s)


@pytest.mark.parametrize(
    ("below", "reading", "said"),
    [
        (-10.0, -12.0, "value reached 12 K, the limit is 10 K"),  # a magnitude
        (-10.0, 12.0, "value reached 12 K, the limit is 10 K"),
        (-5.0, -12.0, "value reached -12 K, the limit is -5 K"),
        (-5.0, 12.0, "value reached 12 K, the limit is 10 K"),
    ],
)
def test_the_words_name_the_end_that_was_reached(below: float, reading: float, said: str) -> None:
    watched, _ = looked(Range("value", below, 10.0, 0.0, "r", "K", 2), [reading] * 3, 1)
    assert [text for _, text in watched.stands()] == [said]


def test_an_open_end_and_what_was_not_seen_are_told_as_such() -> None:
    watched = StreamRanges(STREAM, [Range("value", -math.inf, 10.0, 0.5, "r", "K")])
    result = next(watched.results())
    assert (result.below, result.above, result.persistence_s) == (None, 10.0, 0.5)
    assert (result.of, result.lowest, result.highest) == ("value", None, None)
    counted = next(StreamRanges(STREAM, [Range("value", -5.0, math.inf, 0.5, "r", "K", 3)]).results())
    assert (counted.below, counted.above) == (-5.0, None)
    assert (counted.persistence_s, counted.persistence_samples) == (None, 3)


def test_before_the_first_sample_a_value_is_taken_for_steady() -> None:
    range_ = Range("value", -1e6, 1e6, 0.0, "r", "", None, 0.0, "warn", slope_s=0.05)
    result = next(looked(range_, ramp(10.0), 40)[0].results())
    assert (result.lowest, result.highest) == (0.0, pytest.approx(10.0))


def test_a_trip_is_told_as_long_as_it_stands() -> None:
    range_ = Range("value", -10.0, 10.0, 0.0, "r", "K", 0)
    assert len(looked(range_, [12.0] * 9, 1)[1]) == 9
