"""Power density of a channel by Welch's method.

`scipy.signal.welch` says the same (a test holds them together), but importing scipy.signal takes as long as a
seventh of a diagnosis.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def power_density(
    values: Array,
    step: float,
    length: int,
    *,
    about_mean: bool = True,
    average: Literal["mean", "median"] = "mean",
) -> tuple[Array, Array]:
    """Frequencies in Hz (f,) and the one-sided power density there (f x channels), per Hz.

    Windows of Hann with half overlap (Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70).

    Args:
        values: samples x channels.
        step: time between samples in s.
        length: samples of a window, at most as many as there are.
        about_mean: each window's mean is taken away first.
        average: of the windows; a median leaves blows out, and is freed of its bias for Gaussian noise.
    """
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    parts = np.lib.stride_tricks.sliding_window_view(values, length, axis=0)[:: length - length // 2]
    if about_mean:
        parts = parts - parts.mean(axis=-1, keepdims=True)
    power = np.abs(np.fft.rfft(parts * window)) ** 2 * (step / np.sum(window**2))
    power[..., 1 : -1 if length % 2 == 0 else None] *= 2.0
    if average == "median":
        density = np.median(power, axis=0) / bias_of_median(len(power))
    else:
        density = np.mean(power, axis=0)
    return np.asarray(np.fft.rfftfreq(length, step)), np.asarray(density.T)


def bias_of_median(count: int) -> float:
    """Median over mean of `count` draws with two degrees of freedom: 1 - 1/2 + 1/3 ... (odd counts)."""
    pairs = 2 * np.arange(1, (count - 1) // 2 + 1)
    return float(1.0 + np.sum(1.0 / (pairs + 1.0) - 1.0 / pairs))
