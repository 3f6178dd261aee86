from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from test_plans import Array
from test_plans.metrics import BandEnergy, BandEnergyMotorSpeed, NoValueError
from test_plans.metrics._low_pass import periodogram
from tests.test_plans.signals import STEP, recording_of, time_axis

METRIC = BandEnergyMotorSpeed()


def sine(time_s: Array, amplitude: float, frequency_hz: float, phase: float = 0.0) -> Array:
    return np.asarray(amplitude * np.sin(2 * np.pi * frequency_hz * time_s + phase))


def energy(speed: Array, time_s: Array | None = None) -> float:
    time = time_axis() if time_s is None else time_s
    return METRIC.compute(recording_of(time, motor_speed_rad_s=speed), STEP)


@given(st.floats(0.01, 100.0), st.floats(8.3, 19.7), st.floats(0.0, 6.3))
def test_a_sine_within_the_band_gives_half_its_amplitude_squared(a: float, f: float, phase: float) -> None:
    assert energy(sine(time_axis(), a, f, phase)) == pytest.approx(a**2 / 2, rel=2e-3)


def test_sines_add_up_and_those_outside_do_not_count() -> None:
    time = time_axis()
    inside = sine(time, 0.5, 10.6) + sine(time, 0.3, 15.0)
    outside = sine(time, 2.0, 5.0) + sine(time, 2.0, 25.0)
    assert energy(inside + outside) == pytest.approx((0.5**2 + 0.3**2) / 2, rel=2e-3)


def test_a_line_at_an_edge_counts_with_the_share_of_its_width_that_lies_in_the_band() -> None:
    # 16 s give lines 0.0625 Hz apart: 8 Hz is one of them. A Hann-windowed sine on a line has 2/3 of its
    # energy there and 1/6 on either side: half of the middle and one side are in the band.
    speed = sine(time_axis(), 1.0, 8.0, 0.4)
    assert energy(speed) == pytest.approx(0.5 * (0.5 * 2 / 3 + 1 / 6), rel=1e-3)


@pytest.mark.parametrize("frequency_hz", [7.9995, 8.0, 8.0005, 20.0, 10.6])
def test_one_sample_more_or_less_moves_a_line_at_the_edge_by_its_shift_alone(frequency_hz: float) -> None:
    # A sample more moves a line near the edge by a hundredth of a line's width, and no more is allowed.
    speed = sine(time_axis(), 1.0, frequency_hz, 0.4)
    usual = energy(speed)
    for to_s in (19.999, 20.001):
        metric = BandEnergyMotorSpeed(to_s=to_s)
        other = metric.compute(recording_of(time_axis(), motor_speed_rad_s=speed), STEP)
        assert other == pytest.approx(usual, rel=0.025)


def test_the_window_is_half_open() -> None:
    speed = sine(time_axis(), 1.0, 12.0)
    last = int(np.flatnonzero(np.isclose(time_axis(), STEP.step_s + 20.0))[0])
    broken = speed.copy()
    broken[last] = 1e3  # the sample at the window's end belongs to what follows
    assert energy(broken) == energy(speed)
    broken[last - 1] = 1e3
    assert energy(broken) != energy(speed)


def test_what_follows_the_window_is_not_looked_at_where_stamps_lie_early() -> None:
    speed, early = sine(time_axis(), 1.0, 12.0), time_axis() - 3e-4
    broken = speed.copy()
    broken[int(np.flatnonzero(np.isclose(time_axis(), STEP.step_s + 20.0))[0])] = 1e3
    assert energy(broken, early) == energy(speed, early)


def test_lost_samples_do_not_shift_the_lines() -> None:
    time = time_axis()
    kept = np.arange(len(time)) % 1600 != 7
    assert energy(sine(time, 1.0, 12.0)[kept], time[kept]) == pytest.approx(0.5, rel=2e-3)


def test_a_linear_trend_does_not_count() -> None:
    assert energy(1000.0 + 8.148 * time_axis()) == pytest.approx(0.0, abs=1e-12)


def test_jitter_and_slow_sampling_change_little() -> None:
    jittered = time_axis() + 1e-4 * np.sin(np.arange(25_001))
    assert energy(sine(jittered, 1.0, 12.0), jittered) == pytest.approx(0.5, rel=2e-3)
    slow = time_axis(sample_time_s=0.01)
    assert energy(sine(slow, 1.0, 12.0), slow) == pytest.approx(0.5, rel=2e-3)


def test_what_lies_outside_of_the_window_does_not_count() -> None:
    time = time_axis()
    late = np.where(time - STEP.step_s < 3.99, sine(time, 5.0, 12.0), 0.0)
    assert energy(late) == pytest.approx(0.0, abs=1e-12)


def test_unit_and_definition() -> None:
    assert METRIC.unit == "(rad/s)²"
    assert "from 4 s after the step until 20 s after the step" in METRIC.definition
    assert "from 8 to 20 Hz" in METRIC.definition


def test_no_value() -> None:
    slow = time_axis(sample_time_s=0.04)
    with pytest.raises(NoValueError, match="do not reach 20 Hz"):
        energy(sine(slow, 1.0, 1.0), slow)
    narrow = BandEnergy(channel="motor_speed_rad_s", from_s=0.0, to_s=1.0, from_hz=10.0, to_hz=11.0)
    with pytest.raises(NoValueError, match="narrower than two spectral lines"):
        narrow.compute(recording_of(time_axis(), motor_speed_rad_s=time_axis()), STEP)
    with pytest.raises(ValueError, match="not above from_hz"):
        BandEnergy(channel="motor_speed_rad_s", from_hz=10.0, to_hz=10.0)


@pytest.mark.parametrize("window", ["hann", "boxcar"])
@pytest.mark.parametrize("samples", [3, 100, 1001])
def test_the_spectrum_is_that_of_scipy(samples: int, window: str) -> None:
    values = np.cumsum(np.random.default_rng(1).normal(size=samples)) + 100
    flat = signal.detrend(values, type="linear")
    frequency, density = signal.periodogram(flat, fs=250, window=window, detrend=False, scaling="density")
    found = periodogram(values, 0.004, tapered=window == "hann")
    assert found[0] == pytest.approx(frequency)
    assert found[1] == pytest.approx(density, abs=1e-9 * density.max())


def test_a_band_of_two_lines_is_wide_enough_and_a_narrower_one_is_not() -> None:
    speed = sine(time_axis(), 1.0, 10.0)
    recording = recording_of(time_axis(), motor_speed_rad_s=speed)
    # 16 s: lines 0.0625 Hz apart; three lines hold a Hann-windowed sine, 2.4 of them nearly so
    wide = BandEnergyMotorSpeed(from_hz=9.925, to_hz=10.075)
    assert wide.compute(recording, STEP) == pytest.approx(0.5 * (2 / 3 + 2 / 6 * 0.7), rel=1e-3)
    with pytest.raises(NoValueError, match=r"narrower than two spectral lines of 0\.0625 Hz"):
        BandEnergyMotorSpeed(from_hz=9.94, to_hz=10.06).compute(recording, STEP)


def test_the_band_may_reach_half_the_rate_and_no_further() -> None:
    time = time_axis(sample_time_s=0.01)
    recording = recording_of(time, motor_speed_rad_s=sine(time, 1.0, 12.0))
    assert BandEnergyMotorSpeed(to_hz=50.0).compute(recording, STEP) == pytest.approx(0.5, rel=2e-3)
    with pytest.raises(NoValueError, match=r"^100 samples a second do not reach 50\.1 Hz$"):
        BandEnergyMotorSpeed(to_hz=50.1).compute(recording, STEP)
