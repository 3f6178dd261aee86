"""Periodic excitation: noise from the scatter of periods, nonlinear distortion from the rest.

The robust method for the best linear approximation (Pintelon & Schoukens, System Identification,
2nd ed., ch. 4): P periods of M random-phase realisations. Scatter from period to period is noise;
scatter from realisation to realisation beyond it is stochastic nonlinear distortion. Lines that the
input leaves out show odd and even distortion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft

from hil.analysis.frequency_response._experiment import Experiment
from hil.analysis.frequency_response._quality import UnfitDataError
from hil.analysis.frequency_response._result import Distortion, FrequencyResponse

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_MEAN_OF_PERIOD = 50  # part of a period over which inputs are compared
_LIKE = 0.7  # correlation of the input with itself one period later; fading in and out lowers it
_MOST_CANDIDATES = 20
_REPEATED = 0.05  # of the rms: largest difference of two samples a period apart
_EXCITED = 1e-2  # of the strongest line
_SMOOTHED_LINES = 5


def period_samples(input_: Array) -> int | None:
    """Length of the input's period in samples; None when it holds no two whole periods.

    What lies before and after the periodic part (rest, fading in and out) does not matter.
    """
    values = input_ - np.mean(input_)
    changes = np.flatnonzero(np.diff(values) != 0)
    if changes.size == 0:
        return None
    values = values[changes[0] : changes[-1] + 2]
    count = len(values)
    if count < 8:
        return None
    length = int(fft.next_fast_len(2 * count, real=True))
    product = fft.irfft(np.abs(fft.rfft(values, length)) ** 2, length)[:count]
    energy = np.concatenate([[0.0], np.cumsum(values**2)])
    lags = np.arange(count)
    both = np.sqrt(energy[count - lags] * (energy[-1] - energy[lags]))
    likeness = product[: count // 2 + 1] / np.maximum(both[: count // 2 + 1], 1e-300)
    below = np.flatnonzero(likeness < 0.5)
    if below.size == 0:
        return None
    alike = below[0] + np.flatnonzero(likeness[below[0] :] > _LIKE)
    runs = np.split(alike, np.flatnonzero(np.diff(alike) > 1) + 1) if alike.size else []
    for run in runs[:_MOST_CANDIDATES]:
        period = int(run[np.argmax(likeness[run])])
        part = _periodic_part(input_, period)
        if part.stop - part.start >= 2 * period:
            return period
    return None


def excited_lines(input_: Array, period: int, sample_time_s: float, from_hz: float, to_hz: float) -> int:
    """Number of excited harmonics between two frequencies."""
    part = input_[_periodic_part(input_, period)][:period]
    frequency = np.arange(period // 2 + 1) / (period * sample_time_s)
    inside = (frequency >= from_hz * (1 - 1e-9)) & (frequency <= to_hz * (1 + 1e-9))
    level = np.abs(fft.rfft(part - np.mean(part)))
    return int(np.sum(level[inside] > _EXCITED * np.max(level[1:])))


@dataclass(frozen=True)
class _Realisation:
    """Spectra of the periods of one phase realisation: P x K and O x P x K."""

    input: ComplexArray
    output: ComplexArray


def best_linear_approximation(
    experiments: Sequence[Experiment], period: int, from_hz: float, to_hz: float
) -> FrequencyResponse:
    """Response at the excited harmonics of `period` samples.

    Experiments with equal phases are repeats of one realisation. The first period is left out as
    transient where at least three were recorded.

    Raises:
        UnfitDataError: too_short (fewer than two periods), no_excitation (no excited line in the band).
    """
    step = experiments[0].sample_time_s
    frequency = np.arange(1, period // 2) / (period * step)
    inside = (frequency >= from_hz * (1 - 1e-9)) & (frequency <= to_hz * (1 + 1e-9))
    harmonics = 1 + np.flatnonzero(inside)
    frequency = frequency[inside]
    realisations = _group([_periods(e, period, harmonics) for e in experiments])
    level = np.min([np.abs(np.mean(r.input, axis=0)) for r in realisations], axis=0)
    excited = level > _EXCITED * np.max(level, initial=0.0)
    if not excited.any() or np.max(level) == 0:
        raise UnfitDataError("no_excitation", f"no harmonic of the input lies in {from_hz:g}-{to_hz:g} Hz")
    each = [_response(r, excited) for r in realisations]
    response = np.mean([g for g, _, _ in each], axis=0)
    noise_variance = _smooth(np.mean([v for _, v, _ in each], axis=0) / len(each))
    total = noise_variance
    if len(each) > 1:
        scatter = sum(np.abs(g - response) ** 2 for g, _, _ in each) / (len(each) * (len(each) - 1))
        total = np.maximum(_smooth(np.asarray(scatter)), noise_variance)
    output_variance = _smooth(np.mean([n for _, _, n in each], axis=0))
    power = np.mean([np.abs(np.mean(r.output[:, :, excited], axis=1)) ** 2 for r in realisations], axis=0)
    hold = np.exp(1j * np.pi * experiments[0].hold_s * frequency[excited])
    return FrequencyResponse(
        frequency[excited],
        experiments[0].output_names,
        response * hold,
        power / (power + output_variance),
        np.sqrt(total),
        np.sqrt(2 * output_variance * period * step),
        np.sqrt(total - noise_variance),
        1,
        f"periodic, {len(realisations)} realisations of {len(realisations[0].input)} periods of "
        f"{period * step:.4g} s",
        _distortion(realisations, response, excited, harmonics, frequency),
        realisations=len(realisations),
    )


def _periodic_part(input_: Array, period: int) -> slice:
    """The longest stretch over which the input repeats itself after `period` samples.

    A measured input has single samples that do not, which no mean over a fiftieth of a period shows.
    """
    few = max(1, period // _MEAN_OF_PERIOD)
    difference = np.abs(input_[period:] - input_[:-period])
    around = np.sqrt(np.convolve(difference**2, np.full(few, 1.0 / few), "same"))
    bad = np.flatnonzero(np.minimum(difference, around) > _REPEATED * np.std(input_))
    bounds = np.concatenate([[-1], bad, [len(difference)]])
    longest = int(np.argmax(np.diff(bounds)))
    return slice(int(bounds[longest]) + 1, int(bounds[longest + 1]) + period)


def _periods(experiment: Experiment, period: int, harmonics: npt.NDArray[np.intp]) -> _Realisation:
    """Spectra (per line: half the amplitude) of input and outputs, period by period.

    A mean torque makes the speeds ramp up; the ramp shows in the means of the periods and is taken away.
    """
    repeating = _periodic_part(experiment.input, period)
    whole = (repeating.stop - repeating.start) // period
    if whole < 2:
        raise UnfitDataError(
            "too_short",
            f"its input repeats for {whole} whole periods of {period * experiment.sample_time_s:.4g} s, "
            "2 are needed",
            where=experiment.name,
        )
    skipped = 1 if whole > 2 else 0
    part = slice(repeating.start + skipped * period, repeating.start + whole * period)
    shape = (whole - skipped, period)
    output = experiment.outputs[:, part].reshape(-1, *shape)
    numbers = np.arange(shape[0]) - (shape[0] - 1) / 2
    slope = np.mean(output, axis=2) @ numbers / (numbers @ numbers) / period
    output = output - slope[:, None, None] * np.arange(shape[0] * period).reshape(shape)
    u = fft.rfft(experiment.input[part].reshape(shape), axis=-1)[:, harmonics] / period
    y = fft.rfft(output, axis=-1)[:, :, harmonics] / period
    return _Realisation(u, np.asarray(y, complex))


def _group(realisations: list[_Realisation]) -> list[_Realisation]:
    """Put experiments with the same input phases together as more periods of one realisation."""
    groups: list[_Realisation] = []
    for one in realisations:
        for i, other in enumerate(groups):
            a, b = np.mean(one.input, axis=0), np.mean(other.input, axis=0)
            if np.linalg.norm(a - b) ** 2 < 1e-2 * np.linalg.norm(b) ** 2:
                groups[i] = _Realisation(
                    np.concatenate([other.input, one.input]), np.concatenate([other.output, one.output], 1)
                )
                break
        else:
            groups.append(one)
    return groups


def _response(realisation: _Realisation, excited: npt.NDArray[np.bool_]) -> tuple[ComplexArray, Array, Array]:
    """Response, its noise variance, and the variance of one period's output line (all O x lines)."""
    u, y = realisation.input[:, excited], realisation.output[:, :, excited]
    periods = len(u)
    mean_u = np.mean(u, axis=0)
    response = np.mean(y, axis=1) / mean_u
    error = y - response[:, None, :] * u
    variance = np.sum(np.abs(error - np.mean(error, axis=1, keepdims=True)) ** 2, axis=1) / (periods - 1)
    return response, variance / periods / np.abs(mean_u) ** 2, variance


def _smooth(variance: Array) -> Array:
    """Mean over neighbouring lines: few periods or realisations alone give a wild variance."""
    count = min(_SMOOTHED_LINES, variance.shape[1])
    kernel = np.ones(count)
    weight = np.convolve(np.ones(variance.shape[1]), kernel, mode="same")
    return np.array([np.convolve(row, kernel, mode="same") / weight for row in variance])


def _distortion(
    realisations: Sequence[_Realisation],
    response: ComplexArray,
    excited: npt.NDArray[np.bool_],
    harmonics: npt.NDArray[np.intp],
    frequency: Array,
) -> Distortion | None:
    """Odd and even lines that the input leaves out; None when it leaves out too few."""
    silent = ~excited
    if np.sum(silent) < 4:
        return None
    lines = np.arange(len(excited))
    filled = np.array(
        [
            np.interp(lines, lines[excited], row.real) + 1j * np.interp(lines, lines[excited], row.imag)
            for row in response
        ]
    )
    # What leaks into these lines of the input itself passes the plant linearly and is taken away.
    cleaned = [r.output - filled[:, None, :] * r.input for r in realisations]
    mean_power = np.mean([np.abs(np.mean(c, axis=1)) ** 2 for c in cleaned], axis=0)
    noise_power = np.mean([np.var(c, axis=1, ddof=1) / c.shape[1] for c in cleaned], axis=0)
    odd, even = silent & (harmonics % 2 == 1), silent & (harmonics % 2 == 0)
    level, noise = np.sqrt(2 * mean_power), np.sqrt(2 * noise_power)
    linear = np.array([np.interp(lines, lines[excited], row) for row in _linear_level(realisations, excited)])
    beyond = np.sqrt(np.maximum(level**2 - noise**2, 0.0)) / np.maximum(linear, 1e-300)
    share = np.max([np.median(beyond[:, part], axis=1) for part in (odd, even) if part.any()], axis=0)
    return Distortion(
        frequency[odd], level[:, odd], noise[:, odd], frequency[even], level[:, even], noise[:, even], share
    )


def _linear_level(realisations: Sequence[_Realisation], excited: npt.NDArray[np.bool_]) -> Array:
    """Rms of the output at the excited lines, O x lines, in the output's unit."""
    power = [np.abs(np.mean(r.output[:, :, excited], axis=1)) ** 2 for r in realisations]
    return np.asarray(np.sqrt(2 * np.mean(power, axis=0)))
