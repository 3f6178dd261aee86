from __future__ import annotations

import numpy as np
import pytest

from reports.channel_figures import amplitude_spectrum, stretch_in_words
from reports.labels import THIN


@pytest.mark.parametrize("hann", [True, False])
def test_a_sine_on_a_line_reads_its_amplitude(hann: bool) -> None:
    time = np.arange(16_000) / 1000
    spectrum = amplitude_spectrum(time, 0.7 * np.sin(2 * np.pi * 10.5 * time), hann=hann)
    assert spectrum is not None
    assert spectrum.resolution_hz == pytest.approx(1 / 16)
    top = spectrum.amplitude.argmax()
    assert spectrum.frequency_hz[top] == pytest.approx(10.5)
    assert spectrum.amplitude[top] == pytest.approx(0.7, rel=2e-3)


def test_a_linear_run_up_leaves_nothing() -> None:
    time = np.arange(4_000) / 1000
    spectrum = amplitude_spectrum(time, 5 + 30 * time)
    assert spectrum is not None
    assert spectrum.amplitude.max() < 1e-9


def test_uneven_samples_and_few_missing_ones_are_mended() -> None:
    time = np.arange(16_000) / 1000
    values = np.sin(2 * np.pi * 10.5 * time)
    values[5_000:5_010] = np.nan
    keep = np.random.default_rng(3).uniform(size=16_000) > 0.1
    spectrum = amplitude_spectrum(time[keep], values[keep])
    assert spectrum is not None
    assert spectrum.amplitude.max() == pytest.approx(1.0, rel=0.01)


@pytest.mark.parametrize(
    ("time", "values"),
    [
        (np.arange(8.0), np.ones(8)),
        (np.arange(100.0), np.full(100, np.nan)),
        (np.arange(100.0), np.where(np.arange(100) % 4, 1.0, np.nan)),
        (np.concatenate([np.arange(50), 1e6 + np.arange(50)]), np.ones(100)),
    ],
)
def test_too_little_gives_no_spectrum(time: np.ndarray, values: np.ndarray) -> None:
    assert amplitude_spectrum(time, values) is None


@pytest.mark.parametrize(
    ("lengths", "said"),
    [
        ((20.0, 20.0), "4 to 20"),
        ((30.0,), "4 to 20"),
        ((8.0,), "4 to 8"),
        ((8.0, 30.0, 20.0), "4 to 8 or 20"),
    ],
)
def test_a_caption_says_the_stretch_that_is_shown(lengths: tuple[float, ...], said: str) -> None:
    assert stretch_in_words((4.0, 20.0), lengths) == f"{said}{THIN}s after the step"
