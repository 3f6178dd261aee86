"""The noise of a channel, read from its own spectrum."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels, usable_noise
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_trace


def test_white_noise_is_read_whatever_the_axle_does() -> None:
    assert noise_levels([one_trace()]) == pytest.approx(NOISE, rel=0.1)


def test_a_line_in_the_band_is_left_out() -> None:
    trace = one_trace()
    at = np.arange(len(trace.samples)) * 0.4
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
