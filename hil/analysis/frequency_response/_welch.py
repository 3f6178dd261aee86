"""H1, H2 and Hv from averaged spectra: the classical estimators, for long records and for comparison."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import fft

from hil.analysis.frequency_response._experiment import Experiment
from hil.analysis.frequency_response._quality import UnfitDataError
from hil.analysis.frequency_response._result import FrequencyResponse

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Estimator = Literal["h1", "h2", "hv"]

_HANN_OVERLAP_GAIN = 0.947  # independent averages per Hann window at 50 % overlap, 1/(1 + 2/36)
_LEAST_WINDOWS = 2


def averaged_spectra(
    experiments: Sequence[Experiment],
    from_hz: float,
    to_hz: float,
    *,
    estimator: Estimator = "h1",
    window_s: float | None = None,
) -> FrequencyResponse:
    """Response from cross and auto spectra, Hann windows with half overlap, averaged over everything.

    With S_uu, S_yy, S_yu the averaged spectra (Bendat & Piersol, 4th ed., ch. 6 and 9):
    H1 = S_yu/S_uu (noise on the output), H2 = S_yy/S_uy (noise on the input), and Hv, the geometric
    mean of both (noise on either). γ² = |S_yu|²/(S_uu S_yy), and the variance of each estimate is
    |H|²(1 - γ²)/(γ² n) for n independent averages.

    Args:
        experiments: all with one sample time.
        from_hz: lowest frequency of the result.
        to_hz: highest frequency of the result.
        estimator: which of the three.
        window_s: window length; default: an eighth of the shortest experiment, at least 4 periods of
            `from_hz`, at most half of the experiment.

    Raises:
        UnfitDataError: too_short for two windows, or no_excitation.
    """
    step = experiments[0].sample_time_s
    shortest = min(e.duration_s for e in experiments)
    length_s = window_s or min(max(shortest / 8, 4 / from_hz), shortest / 1.51)
    count = int(fft.prev_fast_len(int(length_s / step), real=True))
    frequency = fft.rfftfreq(count, step)
    wanted = (frequency >= from_hz * (1 - 1e-9)) & (frequency <= to_hz * (1 + 1e-9))
    frequency = frequency[wanted]
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(count) / count)
    scale = step / np.sqrt(step * float(np.sum(window**2)))
    suu, syy, syu, windows = _sums(experiments, window * scale, wanted)
    if windows < _LEAST_WINDOWS or frequency.size == 0:
        raise UnfitDataError(
            "too_short",
            f"{shortest:.3g} s do not hold {_LEAST_WINDOWS} windows of {length_s:.3g} s",
            fix="record longer, shorten the window, or use the local polynomial method",
        )
    if np.min(suu) <= 0:
        raise UnfitDataError("no_excitation", f"the input has no power at {frequency[np.argmin(suu)]:.4g} Hz")
    coherence = np.clip(np.abs(syu) ** 2 / np.maximum(suu * syy, np.finfo(float).tiny), 0.0, 1.0)
    h1 = syu / suu
    shown = np.maximum(coherence, np.finfo(float).eps)
    rate = h1 * shown ** {"h1": 0.0, "h2": -1.0, "hv": -0.5}[estimator]
    deviation = np.abs(rate) * np.sqrt((1 - coherence) / (shown * windows * _HANN_OVERLAP_GAIN))
    s = 2j * np.pi * frequency
    hold = np.exp(0.5 * experiments[0].hold_s * s)
    return FrequencyResponse(
        frequency,
        experiments[0].output_names,
        rate * hold / s,
        coherence,
        deviation / np.abs(s),
        np.sqrt(2 * syy * (1 - coherence)) / np.abs(s),
        np.zeros(coherence.shape),
        2,
        f"{estimator.upper().replace('V', 'v')}, {windows} Hann windows of {count * step:.4g} s",
    )


def _sums(
    experiments: Sequence[Experiment], window: Array, wanted: npt.NDArray[np.bool_]
) -> tuple[Array, Array, ComplexArray, int]:
    """Averaged S_uu (F), S_yy (O x F), S_yu (O x F) of input and differenced outputs, number of windows."""
    count = len(window)
    lines = int(np.sum(wanted))
    outputs = len(experiments[0].output_names)
    suu = np.zeros(lines)
    syy, syu = np.zeros((outputs, lines)), np.zeros((outputs, lines), complex)
    windows = 0
    for experiment in experiments:
        step = experiment.sample_time_s
        s = 2j * np.pi * fft.rfftfreq(count, step)[wanted]
        undo = s / -np.expm1(-s * step)
        input_ = experiment.input[1:]
        output = np.diff(experiment.outputs, axis=1)
        for start in range(0, len(input_) - count + 1, count // 2):
            part = slice(start, start + count)
            u = fft.rfft((input_[part] - input_[part].mean()) * window)[wanted]
            about = output[:, part] - output[:, part].mean(axis=1, keepdims=True)
            y = fft.rfft(about * window)[:, wanted] * undo
            suu += np.abs(u) ** 2
            syy += np.abs(y) ** 2
            syu += y * u.conj()
            windows += 1
    share = max(windows, 1)
    return suu / share, syy / share, np.asarray(syu / share), windows
