"""The likelihood of errors: as Whittle's near the noise, one value an octave far from it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.missing_effects._spectrum import Powers, edges_hz, of_noise, powers_of

RATE_HZ = 250.0


def _white_noise(deviation: float, seed: int = 0) -> Powers:
    errors = np.random.default_rng(seed).normal(0.0, deviation, (100_000, 3))
    return powers_of([errors], RATE_HZ, np.full(3, 1e4))


def test_power_of_white_noise_is_its_variance_in_every_octave() -> None:
    powers = _white_noise(0.3)
    mean = np.sum(powers.power * powers.bins, axis=0) / np.sum(powers.bins, axis=0)
    assert mean[:, 3:] == pytest.approx(0.09, rel=0.2)


def test_noise_holds_two_values_a_bin_and_a_large_misfit_two_an_octave() -> None:
    errors = np.random.default_rng(1).normal(0.0, 1.0, (10_000, 3))
    powers = powers_of([errors], RATE_HZ, np.full(3, 1e-9))
    near, far = powers.values(np.full(3, 1.1)), powers.values(np.full(3, 1e-6))
    bins = 2.0 * float(np.sum(powers.bins))
    windows, octaves = len(powers.power), powers.power.shape[2]
    assert near == pytest.approx(bins, rel=0.05)
    assert far == pytest.approx(2.0 * 0.5 * windows * 3 * octaves, rel=0.1)


def test_slope_is_the_derivative_of_the_likelihood_by_power() -> None:
    noise = np.full(3, 0.1)
    one, more = _white_noise(0.3), _white_noise(0.3)
    more = Powers(more.edges_hz, more.power * 1.0001, more.bins, more.signal)
    grown = np.sum(more.log_likelihood(noise)) - np.sum(one.log_likelihood(noise))
    weights = 1.0 / one.spectrum(noise).variance
    change = np.sum(one.bins * (more.power - one.power) * weights)
    assert grown == pytest.approx(-change, rel=1e-3)


def test_halving_a_misfit_far_from_noise_gains_what_its_octaves_gain() -> None:
    noise = np.full(3, 1e-6)
    large, small = _white_noise(30.0), _white_noise(15.0)
    small = Powers(large.edges_hz, large.power / 4.0, large.bins, np.full(3, 1e-9))
    large = Powers(large.edges_hz, large.power, large.bins, np.full(3, 1e-9))
    gain = np.sum(small.log_likelihood(noise)) - np.sum(large.log_likelihood(noise))
    windows, octaves = len(large.power), large.power.shape[2]
    assert gain == pytest.approx(0.5 * windows * 3 * octaves * np.log(4.0), rel=0.01)


def test_what_can_be_gained_is_what_a_likelihood_at_noise_has_more() -> None:
    """Means at or below noise: nothing; a misfit: what separates it from noise."""
    large = _white_noise(30.0)
    noise = np.full(3, 0.3)
    nothing = np.zeros(1)
    quiet = Powers(large.edges_hz, np.full_like(large.power, 0.09), large.bins, large.signal)
    assert quiet.most_to_gain(noise, nothing) == pytest.approx(0.0, abs=1e-9)
    gained = np.sum(quiet.log_likelihood(noise)) - np.sum(large.log_likelihood(noise))
    assert large.most_to_gain(noise, nothing) == pytest.approx(gained, rel=1e-9)
    assert _white_noise(0.29).most_to_gain(noise, nothing) < 60.0  # of chance in octaves of few bins


def test_squares_of_weighed_windows_add_to_those_of_the_samples() -> None:
    errors = np.random.default_rng(2).normal(0.0, 1.0, (1, 20_000, 2))
    channels = np.array([True, False, True])
    weighed = of_noise(np.full(3, 0.5), RATE_HZ).weighed(errors, channels, RATE_HZ, 0.0)
    assert np.sum(weighed**2) == pytest.approx(np.sum(errors**2) / 0.25, rel=0.05)  # ends count half


def test_a_drift_stays_out_of_the_octaves_of_noise() -> None:
    drift = np.repeat(np.linspace(0.0, 100.0, 5000)[:, None], 3, axis=1)
    powers = powers_of([drift], RATE_HZ, np.full(3, 1e4))
    assert np.max(powers.power[:, :, 5:]) < 1e-6 * np.max(powers.power)


def test_windows_reach_both_ends_of_a_recording() -> None:
    errors = np.zeros((1700, 3))
    errors[-300:] = 1.0
    assert np.sum(powers_of([errors], RATE_HZ, np.ones(3)).power) > 0.0


@pytest.mark.parametrize("blocks", [700, 1000, 2501])
def test_what_is_sent_back_is_the_slope_of_half_the_squares(blocks: int) -> None:
    rng = np.random.default_rng(2)
    errors, change = rng.normal(0.0, 1.0, (2, blocks, 2))
    channels = np.array([True, False, True])
    spectrum = powers_of([np.insert(errors, 1, np.nan, axis=1)], RATE_HZ, np.ones(3)).spectrum(
        np.full(3, 0.1)
    )
    weighed = [spectrum.weighed(one[None], channels, RATE_HZ, 0.0)[0] for one in (errors, change)]
    back = spectrum.sent_back(errors, channels, RATE_HZ, 0.0)
    assert np.sum(back * change) == pytest.approx(weighed[0] @ weighed[1])


def test_the_beginning_counts_as_much_as_the_middle() -> None:
    """What the first window leaves of a block, as it rises, `rising` adds: each block counts once."""
    errors = np.random.default_rng(3).normal(0.0, 1.0, (1, 20_000, 2))
    errors[:, 500:] = 0.0  # of the first window, half
    channels = np.array([True, False, True])
    spectrum = of_noise(np.full(3, 0.5), RATE_HZ)
    both = (
        spectrum.weighed(errors, channels, RATE_HZ, 0.0),
        spectrum.rising(errors, channels, RATE_HZ),
    )
    whole = sum(float(np.sum(one**2)) for one in both)
    assert whole == pytest.approx(np.sum(errors**2) / 0.25, rel=0.1)


def test_what_lies_below_the_excited_octaves_does_not_count() -> None:
    rng = np.random.default_rng(4)
    noise = rng.normal(0.0, 1.0, (5000, 3))
    drift = noise + 100.0 * np.sin(2.0 * np.pi * 0.5 * np.arange(5000)[:, None] / RATE_HZ)
    left = [powers_of([one], RATE_HZ, np.ones(3), [8.0]).mean_square() for one in (noise, drift)]
    assert left[0] == pytest.approx(np.ones(3), rel=0.1)
    assert left[1] == pytest.approx(left[0], rel=1e-3)


def test_what_a_repeated_torque_shows_again_counts_once() -> None:
    """Far from noise ten times the same misfit is one; noise is another in each period."""
    errors = np.tile(np.random.default_rng(2).normal(0.0, 1.0, (1000, 3)), (10, 1))
    each, once = (
        [powers_of([size * errors], RATE_HZ, np.full(3, 1e-9), periods=[times]) for size in (1.0, 0.5)]
        for times in (1.0, 10.0)
    )
    windows, octaves = each[0].power.shape[0], each[0].power.shape[2]
    far, near = np.full(3, 1e-6), np.full(3, 1.1)
    assert each[0].values(far) == pytest.approx(windows * 3 * octaves, rel=0.1)
    assert once[0].values(far) == pytest.approx(2.0 * 3 * octaves, rel=0.1)
    gains = [
        np.sum(small.log_likelihood(far)) - np.sum(large.log_likelihood(far)) for large, small in (each, once)
    ]
    assert gains[1] == pytest.approx(gains[0] / (0.5 * windows), rel=0.05)
    assert once[0].values(near) == pytest.approx(each[0].values(near), rel=0.05)


def test_a_misfit_where_coloured_noise_is_small_is_no_noise() -> None:
    """An angle's noise is small where it is slow: a sum over all octaves would not see what stands there."""
    time = np.arange(8000) / RATE_HZ
    slow = np.column_stack([0.3 * np.sin(2.0 * np.pi * 1.5 * time)] * 3)
    colour = np.ones((3, len(edges_hz(RATE_HZ)) - 1))
    plain = powers_of([slow], RATE_HZ, np.ones(3), colour=colour).mean_square()
    colour[:, :4] = 1e-3
    assert np.all(powers_of([slow], RATE_HZ, np.ones(3), colour=colour).mean_square() > 500.0 * plain)


def _slow_noise(blocks: int, seed: int) -> np.ndarray:
    """White noise of one, and beside it as much that is slower than 5 Hz (three channels)."""
    rng = np.random.default_rng(seed)
    slow = lfilter([1.0], [1.0, -np.exp(-2.0 * np.pi * 5.0 / RATE_HZ)], rng.normal(size=(blocks, 3)), axis=0)
    return np.asarray(rng.normal(size=(blocks, 3)) + slow / np.std(slow))


def test_quiet_windows_tell_the_noise_beside_a_misfit_that_comes_and_goes() -> None:
    noise = _slow_noise(50_000, 3)
    bursts = np.zeros_like(noise)
    for first in range(0, 40_000, 10_000):  # half of the time, of 90 times the power
        time_s = np.arange(5000) / RATE_HZ
        bursts[first : first + 5000] = 30.0 * np.sin(2.0 * np.pi * (0.5 + 2.0 * time_s) * time_s)[:, None]
    alone, beside = (powers_of([one], RATE_HZ, np.ones(3)) for one in (noise, noise + bursts))
    is_noise = np.sum(alone.power * alone.bins, axis=0) / np.sum(alone.bins, axis=0)
    level, most = beside.quiet(np.ones(3))
    assert level[:, 3:] == pytest.approx(is_noise[:, 3:], rel=0.3)
    assert np.all(most[:, 2:] > is_noise[:, 2:])
    assert beside.mean_square(level) == pytest.approx(alone.mean_square(), rel=0.1)
    assert np.all(beside.mean_square() > 50.0 * alone.mean_square())


def test_what_is_in_every_window_and_no_sensors_noise_is_not_taken_for_it() -> None:
    """An offset stands in the lowest octave, a line of turning above quieter ones."""
    noise = _slow_noise(50_000, 4)
    line = 5.0 * np.sin(2.0 * np.pi * 20.0 * np.arange(len(noise)) / RATE_HZ)[:, None]
    alone = powers_of([noise], RATE_HZ, np.ones(3)).mean_square()
    for always in (np.full((1, 3), 5.0), line * np.ones(3)):
        powers = powers_of([noise + always], RATE_HZ, np.ones(3))
        level, most = (powers.mean_square(one) for one in powers.quiet(np.ones(3)))
        assert np.all(level < 1.7 * alone)
        assert np.all(powers.mean_square() > 2.0 * most)


def test_quiet_windows_never_have_less_than_proven_noise() -> None:
    level, most = _white_noise(0.3).quiet(np.ones(3))
    assert level == pytest.approx(1.0)
    assert np.all(most >= level)
