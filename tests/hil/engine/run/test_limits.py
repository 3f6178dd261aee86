"""Limits of channels of any source, and silence of any stream."""

from __future__ import annotations

import numpy as np
import pytest

from drivers import Samples, Stream
from hil.core.errors import BenchError
from hil.engine.bench.ranges import ChannelLimit
from hil.engine.run.limits import LimitWatch
from tests.benches_for_tests import SIM

SLOW = Stream("reading", "device 'oil'", ("oil_temperature_k",), ("K",), 0.1, silence_s=0.5)
FAST = Stream("status", "bus 'rmcu'", ("motor_speed_rad_s", "oil_flow_m3_s"), ("rad/s", "m3/s"), 1e-3)


def watch(**limits: ChannelLimit) -> LimitWatch:
    made = LimitWatch([FAST, SLOW], SIM.limits.model_copy(update={"channels": limits}))
    made.active = True
    return made


def temperatures(*values: float) -> Samples:
    return Samples(SLOW, np.arange(len(values), dtype=np.float64), np.array(values)[:, None])


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ((300.0, 370.0, 371.0), "oil_temperature_k reached 371 K, the limit is 363 K"),
        ((300.0, 250.0, 249.0), "oil_temperature_k reached 249 K, the limit is 263 K"),
        ((300.0, np.nan, np.nan), "oil_temperature_k reached inf K, the limit is 363 K"),
    ],
)
def test_both_ends_of_a_range_trip(values: tuple[float, ...], said: str) -> None:
    with pytest.raises(BenchError, match=said):
        watch(oil_temperature_k=ChannelLimit(below=263.0, above=363.0)).take(temperatures(*values), 0.0)


@pytest.mark.parametrize("limit", [ChannelLimit(above=363.0), ChannelLimit(below=263.0)])
def test_an_open_end_limits_nothing_but_a_value_that_is_not_known(limit: ChannelLimit) -> None:
    inside = -1e5 if limit.below is None else 1e5
    watched = watch(oil_temperature_k=limit)
    watched.take(temperatures(*[inside] * 20), 0.0)
    assert watched.largest["oil_temperature_k"] == 1e5
    with pytest.raises(BenchError, match="limit tripped"):
        watched.take(temperatures(*[np.nan] * 20), 0.0)


def test_one_odd_sample_never_trips_and_the_persistence_counts_in_the_streams_own_samples() -> None:
    odd = [300.0, 370.0] * 20
    watch(oil_temperature_k=ChannelLimit(above=363.0)).take(temperatures(*odd), 0.0)
    patient = watch(oil_temperature_k=ChannelLimit(above=363.0, persistence_s=0.5))
    patient.take(temperatures(*[370.0] * 5), 0.0)
    with pytest.raises(BenchError, match="limit tripped"):
        patient.take(temperatures(370.0), 0.0)


def test_a_channel_may_have_a_limit_beside_that_of_the_axle() -> None:
    watched = watch(motor_speed_rad_s=ChannelLimit(below=-1.0))
    backwards = np.column_stack([np.full(20, -2.0), np.zeros(20)])
    with pytest.raises(BenchError, match="motor_speed_rad_s reached -2 rad/s, the limit is -1 rad/s"):
        watched.take(Samples(FAST, np.arange(20, dtype=np.float64), backwards), 0.0)


def test_the_advice_fits_the_quantity() -> None:
    with pytest.raises(BenchError) as hot:
        watch(oil_temperature_k=ChannelLimit(above=363.0)).take(temperatures(*[370.0] * 5), 0.0)
    assert "let it cool down" in hot.value.fix
    assert "torque" not in hot.value.fix
    backwards = np.column_stack([np.full(20, -2.0), np.zeros(20)])
    watched = watch(motor_speed_rad_s=ChannelLimit(below=-1.0))
    with pytest.raises(BenchError) as fast:
        watched.take(Samples(FAST, np.arange(20, dtype=np.float64), backwards), 0.0)
    assert fast.value.fix == "lower the plan's torque or speed; the limit is in the bench file"


def listen(watched: LimitWatch, from_s: float, to_s: float) -> None:
    """Look every 10 ms, as the loop does."""
    for now_s in np.arange(from_s, to_s, 0.01):
        watched.look_for_silence(float(now_s))


def fast_goes_on(watched: LimitWatch, from_s: float, to_s: float) -> None:
    for now_s in np.arange(from_s, to_s, 0.05):
        watched.take(Samples(FAST, np.zeros(1), np.zeros((1, 2))), float(now_s))
        listen(watched, float(now_s), float(now_s) + 0.05)


def test_each_stream_has_its_own_silence() -> None:
    watched = watch()
    fast = Samples(FAST, np.zeros(1), np.zeros((1, 2)))
    watched.take(fast, 1.0)
    watched.take(temperatures(300.0), 1.0)
    listen(watched, 1.0, 1.095)
    with pytest.raises(BenchError, match=r"bus 'rmcu': status has stopped coming"):
        listen(watched, 1.095, 1.2)
    fast_goes_on(watched, 1.2, 1.45)
    with pytest.raises(BenchError, match=r"device 'oil': reading has stopped coming"):
        fast_goes_on(watched, 1.45, 1.7)


def heard() -> LimitWatch:
    """Every stream came at 1 s."""
    watched = watch()
    watched.take(Samples(FAST, np.zeros(1), np.zeros((1, 2))), 1.0)
    watched.take(temperatures(300.0), 1.0)
    watched.look_for_silence(1.0)
    return watched


def test_a_pause_of_the_own_loop_is_no_silence_of_a_device() -> None:
    watched = watch()
    fast = Samples(FAST, np.zeros(1), np.zeros((1, 2)))
    watched.take(fast, 1.0)
    watched.take(temperatures(300.0), 1.0)
    listen(watched, 1.0, 1.05)
    watched.look_for_silence(1.35)
    assert (watched.pauses.count, round(watched.pauses.longest_s, 1)) == (1, 0.3)
    assert watched.pauses.blamed_at(1.4) == "the bench loop was delayed by 0.3 s just before"
    assert watched.pauses.blamed_at(2.0) == ""
    listen(watched, 1.36, 1.4)
    with pytest.raises(BenchError, match="status has stopped coming"):  # what was silent before goes on to be
        listen(watched, 1.4, 1.43)


def test_a_pause_beyond_the_bound_is_a_fault_of_this_computer() -> None:
    watched = heard()
    with pytest.raises(
        BenchError, match=r"this computer: the bench loop was delayed by 0.7 s, more than 0.5 s"
    ):
        watched.look_for_silence(1.7)


def test_before_it_is_active_nothing_is_a_pause() -> None:
    watched = heard()
    watched.active = False
    watched.look_for_silence(1.0)
    watched.look_for_silence(5.0)
    watched.take(Samples(FAST, np.zeros(1), np.zeros((1, 2))), 5.0)
    watched.take(temperatures(300.0), 5.0)
    watched.active = True
    watched.look_for_silence(5.01)
    assert watched.pauses.count == 0
