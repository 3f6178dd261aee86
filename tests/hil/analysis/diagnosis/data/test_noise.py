"""The noise of a channel, read from its own spectrum."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import cancelling, noise_levels, rising, usable_noise
from hil.analysis.diagnosis.data.thresholds import FLOOR_BAND
from hil.analysis.diagnosis.data.trace import Trace, trace_of
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.recording import Recording
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_trace, recorded


def test_white_noise_is_read_whatever_the_axle_does() -> None:
    assert noise_levels([one_trace()]) == pytest.approx(NOISE, rel=0.1)


def test_a_line_in_the_band_is_left_out() -> None:
    trace = one_trace()
    at = np.arange(len(trace.samples)) * sum(FLOOR_BAND) / 2
    loud = dataclasses.replace(trace, samples=trace.samples + 3.0 * np.sin(2 * np.pi * at)[:, None])
    assert noise_levels([loud]) == pytest.approx(NOISE, rel=0.15)


def test_a_channel_that_no_recording_has_has_no_noise() -> None:
    trace = one_trace()
    without = trace.samples.copy()
    without[:, 2] = np.nan
    mute = dataclasses.replace(trace, samples=without, measured=without[: len(trace.measured)])
    assert np.isnan(noise_levels([mute])[2])
    assert noise_levels([mute, trace])[2] == noise_levels([trace])[2]


def test_no_noise_at_all_still_weighs() -> None:
    assert usable_noise(np.array([0.0, 2.0, np.nan])) == pytest.approx([1e-6, 2.0, np.nan], nan_ok=True)


def encoder(counts: float, seconds: float = 20.0) -> Trace:
    """A slow motion read as differences of positions that are rounded to `counts` radians."""
    time = np.arange(0.0, seconds, 1e-3)
    angle = 40.0 * time + 20.0 * np.sin(2.0 * np.pi * 0.3 * time)
    speed = np.diff(np.round(angle / counts) * counts, prepend=0.0) / 1e-3
    channels = {TIME: time, INPUT: np.sin(time), OUTPUTS[0]: speed}
    return trace_of(Recording(channels, Path("encoder.csv")))


def test_errors_of_differentiated_positions_cancel_in_means() -> None:
    """Rounding of u gives positions u/sqrt(12) of noise, speeds sqrt(2) of that over a sample."""
    counts = 1e-3
    trace = encoder(counts)
    level = noise_levels([trace])
    means = cancelling([trace], level)
    exact = np.sqrt(2.0) * counts / np.sqrt(12.0) / 1e-3
    assert rising([trace], means, level)[0] == pytest.approx(exact, rel=0.07)
    # a mean over a block has the error of its two ends: exact / block; its spectrum is read near its top
    assert 1.0 <= means[0] / (exact / np.sqrt(trace.block)) <= np.sqrt(2.0)
    assert np.isnan(means[1:]).all()


def test_white_noise_does_not_cancel() -> None:
    trace = trace_of(recorded(seconds=8.0))
    level = noise_levels([trace])
    means = cancelling([trace], level)
    assert np.isnan(means).all()
    assert np.array_equal(rising([trace], means, level), level)
