"""Where something acts, and where a gap that stays lies, in words."""

import numpy as np
import pytest

from hil.analysis.diagnosis.data.gap import gap_map
from hil.analysis.diagnosis.findings.words import band_of_gap, where_changed
from hil.core.channels import OUTPUTS
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_series

LEVELS = np.array(NOISE)


def test_a_wave_in_one_channel_is_placed() -> None:
    trace = one_series()
    wave = np.zeros_like(trace.samples)
    wave[:, 2] = 30.0 * np.sin(2 * np.pi * 10.0 * np.arange(len(wave)) * trace.dt)
    maps = [gap_map([trace], LEVELS, [s]) for s in (trace.samples - wave, trace.samples)]
    found = where_changed([trace], LEVELS, [trace.samples - wave], [trace.samples], *maps)
    assert found.channels == (OUTPUTS[2],)
    assert found.band_hz[0] < 10.0 < found.band_hz[1]


@pytest.mark.parametrize("frequency_hz", [7.0, 13.0])
def test_a_line_that_stays_is_called_one(frequency_hz: float) -> None:
    trace = one_series(seconds=16.0)
    time = np.arange(len(trace.samples)) * trace.dt
    noise = np.random.default_rng(3).normal(0.0, 1.0, len(time))
    shown = trace.samples.copy()
    shown[:, 2] += 3.0 * NOISE[2] * np.sin(2 * np.pi * frequency_hz * time) + NOISE[2] * noise
    words = band_of_gap([trace], LEVELS, [shown], 2)
    assert words.startswith("it is a line at ")
    assert float(words.split()[-2]) == pytest.approx(frequency_hz, abs=0.2)


def test_a_gap_that_is_broad_lies_between_two_frequencies() -> None:
    trace = one_series(seconds=16.0)
    time = np.arange(len(trace.samples)) * trace.dt
    shown = trace.samples.copy()
    shown[:, 0] += 5.0 * NOISE[0] * np.sin(2 * np.pi * (2.0 * time + 0.5 * time**2))  # 2 to 18 Hz
    words = band_of_gap([trace], LEVELS, [shown], 0)
    low, high = (float(part) for part in words.split() if part.replace(".", "").isdigit())
    assert 2.0 < low < 6.0
    assert 13.0 < high < 19.0
