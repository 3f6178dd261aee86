from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import signal

from hil.analysis.frequency_response import Experiment, UnfitDataError, averaged_spectra
from hil.core.channels import OUTPUTS

STEP = 0.002


def experiment(input_noise: float, output_noise: float, seed: int = 0) -> Experiment:
    """A first-order lag with pole 20 rad/s, driven by noise, measured with noise on either side."""
    rng = np.random.default_rng(seed)
    torque = rng.standard_normal(200_000)
    decay = np.exp(-20 * STEP)
    speed = signal.lfilter([0.0, 1 - decay], [1.0, -decay], torque)
    return Experiment(
        "lag",
        STEP,
        torque + input_noise * rng.standard_normal(len(torque)),
        (speed + output_noise * rng.standard_normal(len(torque)))[None, :],
        OUTPUTS[:1],
        hold_s=STEP,
    )


def gain_error(estimator: str, one: Experiment) -> float:
    frf = averaged_spectra([one], 0.5, 10, estimator=estimator, window_s=8.0)  # type: ignore[arg-type]
    truth = 20 / (2j * np.pi * frf.frequency_hz + 20)
    return float(np.mean(np.abs(frf.response[0]) / np.abs(truth)) - 1)


def test_h1_ignores_noise_on_the_output() -> None:
    assert abs(gain_error("h1", experiment(0, 0.3))) < 0.02


def test_h2_ignores_noise_on_the_input() -> None:
    noisy = experiment(0.5, 0)
    assert abs(gain_error("h2", noisy)) < 0.02
    assert gain_error("h1", noisy) < -0.15


def test_hv_lies_between() -> None:
    noisy = experiment(0.5, 0.3)
    low, middle, high = (gain_error(e, noisy) for e in ("h1", "hv", "h2"))
    assert low < middle < high


def test_agrees_with_scipy() -> None:
    """The same windows through scipy.signal.csd give the same H1 and coherence."""
    one = experiment(0, 0.2)
    frf = averaged_spectra([one], 0.5, 10, window_s=8.0)
    count = 4000
    options: dict[str, Any] = {
        "fs": 1 / STEP,
        "nperseg": count,
        "noverlap": count // 2,
        "detrend": "constant",
    }
    rate = np.diff(one.outputs[0])
    frequency, cross = signal.csd(one.input[1:], rate, **options)
    _, auto = signal.welch(one.input[1:], **options)
    _, coherence = signal.coherence(one.input[1:], rate, **options)
    inside = (frequency >= 0.5) & (frequency <= 10.0001)
    s = 2j * np.pi * frequency[inside]
    reference = cross[inside] / auto[inside] / -np.expm1(-s * STEP) * np.exp(0.5 * STEP * s)
    np.testing.assert_allclose(frf.frequency_hz, frequency[inside])
    np.testing.assert_allclose(frf.response[0], reference, rtol=1e-9)
    np.testing.assert_allclose(frf.coherence[0], coherence[inside], rtol=1e-9)


def test_stated_uncertainty_is_the_real_one() -> None:
    ratios = []
    for seed in range(4):
        frf = averaged_spectra([experiment(0, 0.3, seed)], 0.5, 10, window_s=8.0)
        truth = 20 / (2j * np.pi * frf.frequency_hz + 20)
        ratios.append(np.mean(np.abs(frf.response[0] - truth) ** 2 / frf.standard_deviation[0] ** 2))
    assert np.sqrt(np.mean(ratios)) == pytest.approx(1, abs=0.2)


def test_repeats_are_averaged() -> None:
    both = averaged_spectra([experiment(0, 0.3, 1), experiment(0, 0.3, 2)], 0.5, 10, window_s=8.0)
    one = averaged_spectra([experiment(0, 0.3, 1)], 0.5, 10, window_s=8.0)
    ratio = np.median(both.standard_deviation) / np.median(one.standard_deviation)
    assert ratio == pytest.approx(1 / np.sqrt(2), rel=0.1)


def test_a_window_longer_than_the_record_is_refused() -> None:
    with pytest.raises(UnfitDataError, match="too short"):
        averaged_spectra([experiment(0, 0)], 0.5, 10, window_s=300.0)
