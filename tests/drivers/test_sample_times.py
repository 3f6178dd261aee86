"""Late, bunched, lost, doubled and overtaken frames move no sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, event, given, note, settings
from hypothesis import strategies as st

from drivers import SampleAssembler
from hil.core.can.frames import FrameBlock
from hil.core.errors import BenchError
from tests.drivers.wires import (
    BEGIN,
    CONTROL,
    LEFT,
    PERIOD_S,
    RIGHT,
    STATUS,
    SYNC,
    Wire,
    held_up,
    in_bursts,
    recorded,
    rmcu_source,
)

SAMPLES = 1200
RMCU, DYNO = (0x200, STATUS, CONTROL), (SYNC, LEFT, RIGHT)
Columns = dict[str, np.ndarray]
Late = Callable[[FrameBlock], FrameBlock]


def rmcu(samples: int = SAMPLES, **changes: object) -> FrameBlock:
    return Wire("rmcu", RMCU, **changes).sent(samples)  # type: ignore[arg-type]


def dyno(samples: int = SAMPLES, **changes: object) -> FrameBlock:
    return Wire("dyno", DYNO, **changes).sent(samples)  # type: ignore[arg-type]


def places(columns: Columns) -> np.ndarray:
    """Each row's sample, by what was measured in it; the row must lie where that sample was."""
    samples = columns["motor_speed_rad_s"].astype(int)
    np.testing.assert_allclose(columns["time_s"], (samples - samples[0]) * PERIOD_S, atol=1e-9)
    assert np.all(np.diff(samples) > 0)
    return samples


def aside(columns: Columns, channel: str) -> np.ndarray:
    """By how many samples another device's value is not that of its row; -1000 where there is none."""
    return np.nan_to_num(columns[channel] - columns["motor_speed_rad_s"], nan=-1000.0)


@pytest.mark.parametrize("size_s", [0.001, 0.002])
def test_jitter_of_one_device_up_to_2_ms_ends_no_run(size_s: float) -> None:
    for seed in range(4):
        random = np.random.default_rng(seed)
        block = dyno()
        assembler, _ = recorded(rmcu(), held_up(block, random.uniform(0, size_s, len(block))))
        assembler.look_for_parted_clocks()


def timing(assembler: SampleAssembler, label: str) -> tuple[int, int]:
    (found,) = (t for t in assembler.timings() if label in t.stream.label)
    return found.lost, found.left_out


@st.composite
def ways(draw: st.DrawFn, held_up_s: float = 0.05, noise_s: float = 0.05) -> Late:
    """What an adapter does to the stamps of frames, in the order in which they come.

    `held_up_s`, `noise_s`: at most so much where every frame is late by a delay of its own, in order or not.
    """
    kind = draw(st.sampled_from(["bursts", "held up", "noise", "pauses", "outliers"]))
    size_s = draw(st.floats(1e-4, {"held up": held_up_s, "noise": noise_s}.get(kind, 0.05)))
    seed = draw(st.integers(0, 1000))
    note(f"{kind} {size_s} s, seed {seed}")
    random = np.random.default_rng(seed)

    def late(block: FrameBlock) -> FrameBlock:
        if kind == "bursts":
            return in_bursts(block, max(1e-3, 0.2 * size_s))
        if kind == "held up":
            return held_up(block, random.uniform(0, size_s, len(block)))
        rare = random.random(len(block)) < 3e-3
        if kind == "pauses":
            return held_up(block, rare * size_s)
        noisy = block.copy()  # the order of the frames is that of the bus, whatever their stamps say
        noisy["time_s"] += random.uniform(0, size_s, len(block)) * (rare if kind == "outliers" else 1)
        return noisy

    return late


@settings(max_examples=25, deadline=None)
@given(way=ways())
def test_no_jitter_up_to_50_ms_moves_a_sample_of_the_time_base(way: Late) -> None:
    assembler, columns = recorded(way(rmcu()), dyno())
    samples = places(columns)
    assert len(samples) == samples[-1] - samples[0] + 1
    assert samples[-1] == SAMPLES - 1
    assert np.all(aside(columns, "state")[:-50] == 0)  # the other frame of the same device
    assert timing(assembler, "0x110") == (0, 0)
    assembler.look_for_parted_clocks()


@settings(max_examples=20, deadline=None)
@given(every_s=st.sampled_from([0.001, 0.0013, 0.002, 0.0025, 0.003, 0.004]), pauses=st.integers(0, 3))
def test_in_bursts_each_row_has_the_dynos_sample_of_the_same_millisecond(every_s: float, pauses: int) -> None:
    def late(block: FrameBlock) -> FrameBlock:
        delays = np.zeros(len(block))
        delays[np.linspace(1000, len(block) - 500, pauses).astype(int)] = 0.05
        return in_bursts(held_up(block, delays), every_s)

    assembler, columns = recorded(late(rmcu()), late(dyno()))
    samples = places(columns)
    for channel in ("shaft_torque_left_nm", "shaft_torque_right_nm"):
        apart = aside(columns, channel)[70:-120]
        assert np.all(apart == 0)
    assert len(samples) == samples[-1] - samples[0] + 1
    assert timing(assembler, "SYNC") == (0, 0)


@settings(max_examples=20, deadline=None)
@given(way=ways(held_up_s=0.002, noise_s=0.01))  # beyond, who has no counter may take delays for a loss
def test_a_device_that_jitters_alone_is_off_by_one_constant_or_ends_the_run(way: Late) -> None:
    assembler, columns = recorded(rmcu(), way(dyno()))
    try:
        assembler.look_for_parted_clocks()
    except BenchError:
        event("said to have parted")
        return
    places(columns)
    for channel in ("shaft_torque_left_nm", "shaft_torque_right_nm"):
        apart = aside(columns, channel)[70:-120]
        assert len(np.unique(apart)) == 1, np.unique(apart, return_counts=True)


losses = st.lists(
    st.tuples(st.integers(BEGIN + 60, SAMPLES - 350), st.sampled_from([1, 1, 2, 5, 15, 16, 17, 60, 100])),
    max_size=4,
)


@settings(max_examples=25, deadline=None)
@given(way=ways(), gaps=losses, singles=st.sets(st.integers(BEGIN + 60, SAMPLES - 100), max_size=6))
def test_what_is_lost_is_a_gap_and_is_counted(
    way: Late, gaps: list[tuple[int, int]], singles: set[int]
) -> None:
    gone = {k for first, count in gaps for k in range(first, first + count)}
    assume(all(len(set(range(k, k + 150)) & gone) < 120 for k in gone))  # a device that is silent ends a run
    lost = {(k, frame) for k in gone for frame in RMCU} | {(k, STATUS) for k in singles}
    assembler, columns = recorded(way(rmcu(lost=lost)), dyno())
    samples = places(columns)
    assert not set(samples) & (gone | singles)
    never, doubtful = timing(assembler, "0x110")
    assert never == len(gone | singles)
    assert never + doubtful == samples[-1] - samples[0] + 1 - len(samples)
    assert doubtful <= len(gaps) + len(singles)


@settings(max_examples=15, deadline=None)
@given(
    way=ways(),
    rmcu_twice=st.sets(
        st.tuples(st.integers(0, SAMPLES - 1), st.sampled_from([STATUS, CONTROL])), max_size=9
    ),
    dyno_twice=st.sets(st.tuples(st.integers(0, SAMPLES - 1), st.sampled_from([SYNC, LEFT])), max_size=9),
)
def test_frames_that_come_twice_are_one_sample(
    way: Late, rmcu_twice: set[tuple[int, int]], dyno_twice: set[tuple[int, int]]
) -> None:
    assembler, columns = recorded(way(rmcu(twice=rmcu_twice)), dyno(twice=dyno_twice))
    samples = places(columns)
    assert len(samples) == samples[-1] - samples[0] + 1
    assert timing(assembler, "0x110") == (0, 0)
    assert len(np.unique(aside(columns, "shaft_torque_left_nm")[70:-120])) == 1


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 1000), farthest=st.integers(1, 45))
def test_counted_frames_that_overtook_each_other_lie_where_they_were_measured(
    seed: int, farthest: int
) -> None:
    block = rmcu()
    moved = np.flatnonzero(block["id"] == CONTROL)
    place = np.arange(len(moved)) + np.random.default_rng(seed).uniform(0, farthest, len(moved))
    block["data"][moved] = block["data"][moved][np.argsort(place, kind="stable")]
    source = rmcu_source(8)
    stream = source.streams[1]
    source.take("rmcu", block[block["id"] == CONTROL])
    (samples,) = source.samples()
    assembler = SampleAssembler([replace(stream)], PERIOD_S)
    base = samples._replace(stream=next(iter(assembler._waiting)))
    assembler.add(base)
    rows = assembler.rows(everything=True)
    np.testing.assert_allclose(rows[:, 0], (rows[:, 1] - rows[0, 1]) * PERIOD_S, atol=1e-9)
    assert len(rows) == SAMPLES


@pytest.mark.parametrize("drift", [-2e-4, 1e-5, 3e-4])
def test_clocks_that_drift_apart_are_measured_and_followed(drift: float) -> None:
    n = 6000
    late = np.random.default_rng(1).uniform(0, 0.002, 3 * n)
    assembler, columns = recorded(rmcu(n), held_up(dyno(n, drift=drift), late))
    places(columns)
    (sync,) = (t for t in assembler.timings() if "SYNC" in t.stream.label)
    assert sync.drift_ppm == pytest.approx(drift * 1e6, abs=15)
    k = columns["motor_speed_rad_s"]
    true_s = columns["shaft_torque_left_nm"] * PERIOD_S * (1 + drift) - k * PERIOD_S
    assert np.ptp(true_s[20:-20]) < 1.5e-3  # a whole sample, and what frames on their way hide
    assembler.look_for_parted_clocks()


def test_a_clock_that_drifts_beyond_what_quartz_does_ends_the_run() -> None:
    n = 9000
    assembler, _ = recorded(rmcu(n), dyno(n, drift=2e-3))
    with pytest.raises(BenchError, match="ppm too slow|off a whole number"):
        assembler.look_for_parted_clocks()


@pytest.mark.parametrize("seed", range(4))
def test_who_is_blamed_is_whose_count_leaves_the_benchs_clock(seed: int) -> None:
    """Damaged counters of the time base make the other device's clock look wrong."""
    n, random = 9000, np.random.default_rng(seed)
    block = rmcu(n)
    place = (block["id"] == CONTROL) & (block["time_s"] > 6.0) & (random.random(len(block)) < 0.02)
    block["data"][place] ^= random.integers(1, 1 << 40, int(place.sum()), dtype=np.uint64)
    assembler, _ = recorded(block, dyno(n))
    with pytest.raises(BenchError) as caught:
        assembler.look_for_parted_clocks()
    assert caught.value.where == "bus 'rmcu'"
    assert caught.value.what.startswith("frame 0x110")


def test_a_device_whose_count_leaves_its_time_ends_the_run() -> None:
    n = 9000
    block = dyno(n)
    block["time_s"][block["time_s"] > 5.0 + 5.5] += 0.0126  # nothing was lost: it stood still
    assembler, _ = recorded(rmcu(n), block)
    with pytest.raises(BenchError, match="a gap is -?0.4 ms off a whole number"):
        assembler.look_for_parted_clocks()


@pytest.mark.parametrize("before", [1, 200, 1000, 4000])
def test_time_that_stood_still_for_all_is_no_loss_of_those_who_count_only_frames(before: int) -> None:
    """A counter says that nothing was lost; who has none takes the pause for 39 lost samples."""
    n, step = 12000, 4300
    blocks = [rmcu(n), dyno(n)]
    for block in blocks:
        block["time_s"][block["time_s"] > 5.0 + step * PERIOD_S] += 0.039
    started = blocks[1]["time_s"] > 5.0 + (step - before) * PERIOD_S
    assembler, _ = recorded(blocks[0], blocks[1][started])
    with pytest.raises(BenchError, match=r"(39.0 ms earlier than their number says|moved by 39 ms at once)"):
        assembler.look_for_parted_clocks()
