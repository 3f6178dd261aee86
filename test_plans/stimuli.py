"""Torque requests over time.

Every function returns a one-dimensional array in the unit of its arguments (N m in plans), one value a
sample, to be held for `sample_time_s` (zero-order hold). Sample k stands for the time k·sample_time_s.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from test_plans.conductor import Array

Sweep = Literal["linear", "logarithmic"]


def step(from_: float, to: float, before_s: float, after_s: float, sample_time_s: float) -> Array:
    """`from_` for `before_s`, then `to` for `after_s`."""
    before, after = count(before_s, sample_time_s), count(after_s, sample_time_s)
    return np.repeat(np.array([from_, to], dtype=float), [before, after])


def ramp(
    from_: float, to: float, before_s: float, duration_s: float, after_s: float, sample_time_s: float
) -> Array:
    """`from_` for `before_s`, a straight line to `to` over `duration_s`, then `to` for `after_s`."""
    length = count(duration_s, sample_time_s)
    line = from_ + (to - from_) * np.arange(length) / length
    before = np.full(count(before_s, sample_time_s), from_, dtype=float)
    after = np.full(count(after_s, sample_time_s), to, dtype=float)
    return np.concatenate([before, line, after])


def stairs(levels: Sequence[float], times_s: Sequence[float], sample_time_s: float) -> Array:
    """Each of `levels` for its time."""
    counts = [count(time_s, sample_time_s) for time_s in times_s]
    return np.repeat(np.asarray(levels, dtype=float), counts)


def chirp(
    from_hz: float,
    to_hz: float,
    duration_s: float,
    amplitude: float,
    sample_time_s: float,
    *,
    bias: float = 0.0,
    sweep: Sweep = "logarithmic",
    fade_s: float = 0.0,
) -> Array:
    """A sine whose frequency runs from `from_hz` to `to_hz`, around `bias`.

    The instantaneous frequency grows linearly or exponentially with time, and the sine starts at
    phase zero (`scipy.signal.chirp` with phi = -90 degrees). Sine and bias together are faded in and
    out by raised cosines of `fade_s`, so a bias above the amplitude never lets the torque reverse.
    """
    samples = count(duration_s, sample_time_s)
    time = np.arange(samples) * sample_time_s
    if sweep == "linear":
        cycles = from_hz * time + (to_hz - from_hz) / (2 * duration_s) * time**2
    else:
        growth = np.log(to_hz / from_hz) / duration_s
        cycles = from_hz / growth * np.expm1(growth * time)
    wave = bias + amplitude * np.sin(2 * np.pi * cycles)
    return wave * fades(samples, count(fade_s, sample_time_s))


def multisine(
    lines: Sequence[int],
    period_s: float,
    periods: int,
    seed: int,
    sample_time_s: float,
    *,
    rms: float | None = None,
    amplitude: float | None = None,
    bias: float = 0.0,
    fade_s: float = 0.0,
) -> Array:
    """A sum of sines at `lines`/`period_s` Hz with random phases, `periods` times the same period.

    All lines have one amplitude. It is scaled to `rms` or, if that is None, to the largest magnitude
    `amplitude`, both without bias. The periodic signal goes on for `fade_s` before the first and after
    the last period, faded by raised cosines, so that every one of `periods` is whole. Phases are
    uniform and depend on `seed` alone.

    Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach, 2012, ch. 5.
    """
    samples = count(period_s, sample_time_s)
    phases = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, len(lines))
    spectrum = np.zeros(samples // 2 + 1, dtype=complex)
    spectrum[np.asarray(lines)] = np.exp(1j * phases)
    period = np.fft.irfft(spectrum, samples)
    if rms is not None:
        period *= rms / np.sqrt(np.mean(period**2))
    elif amplitude is not None:
        period *= amplitude / np.max(np.abs(period))
    fade = count(fade_s, sample_time_s)
    position = np.arange(-fade, periods * samples + fade) % samples
    return (bias + period[position]) * fades(len(position), fade)


def multisine_lines(from_hz: float, to_hz: float, period_s: float, *, odd_only: bool = False) -> list[int]:
    """Multiples of 1/`period_s` from `from_hz` to `to_hz`, both included; with `odd_only` the odd ones.

    Odd lines alone leave the even ones free to show even-order nonlinearity.
    """
    # A part in 1e9 of a line forgives binary fractions (0.1 Hz over 10 s is line 1).
    first = max(1, int(np.ceil(from_hz * period_s - 1e-9)))
    last = int(np.floor(to_hz * period_s + 1e-9))
    return [line for line in range(first, last + 1) if line % 2 or not odd_only]


def fades(samples: int, fade: int) -> Array:
    """An envelope of `samples` ones whose first and last `fade` samples are raised cosines."""
    envelope = np.ones(samples)
    if fade:
        rise = 0.5 - 0.5 * np.cos(np.pi * np.arange(fade) / fade)
        envelope[:fade] = rise
        envelope[-fade:] = rise[::-1]
    return envelope


def count(duration_s: float, sample_time_s: float) -> int:
    """Samples in `duration_s`."""
    return round(duration_s / sample_time_s)
