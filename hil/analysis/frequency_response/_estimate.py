"""From experiments to one frequency response: which method, which band, good enough or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from hil.analysis.frequency_response._experiment import Experiment, Lines, fourier_lines
from hil.analysis.frequency_response._local_polynomial import local_polynomial
from hil.analysis.frequency_response._periodic import (
    best_linear_approximation,
    excited_lines,
    period_samples,
)
from hil.analysis.frequency_response._quality import (
    LEAST_PERIODS,
    UnfitDataError,
    check_coherence,
    check_excitation,
    check_length,
    check_signals,
    excited_bands,
)
from hil.analysis.frequency_response._result import FrequencyResponse
from hil.analysis.frequency_response._welch import averaged_spectra
from hil.core.errors import BadInputError

Method = Literal["auto", "lpm", "periodic", "h1", "h2", "hv"]

DEFAULT_BAND_HZ = (0.05, 30.0)
_MOST_PERIODIC_LINES = 1000
_LEAST_COHERENCE = 0.5
_ALLOWED_LOW_SHARE = 0.25
_REFERENCE_SHARE = 0.5  # of the input's lines that the reference must explain to be of use


def estimate(
    experiments: Sequence[Experiment],
    *,
    from_hz: float | None = None,
    to_hz: float | None = None,
    method: Method = "auto",
    points: int = 400,
    window_s: float | None = None,
) -> FrequencyResponse:
    """Frequency response of all experiments together.

    'auto' takes the periodic method for multisines and other sparse periodic inputs, the joint
    input-output method where a reference excites the loop, and the local polynomial method otherwise.
    A band that is not given is 0.05-30 Hz as far as the input excites it.

    Args:
        experiments: at least one, all with the same outputs.
        from_hz: lowest frequency; given, the data must cover it.
        to_hz: highest frequency; given, the data must cover it.
        method: how to estimate.
        points: largest number of frequencies of the local polynomial method.
        window_s: window of H1, H2, Hv.

    Raises:
        UnfitDataError: the data cannot give this response; the message says why and where.
        BadInputError: unknown method, band upside down, or experiments that do not go together.
    """
    where = experiments[0].name if len(experiments) == 1 else f"{len(experiments)} experiments"
    if method not in get_args(Method):
        raise BadInputError(f"unknown method '{method}'", fix=f"methods: {', '.join(get_args(Method))}")
    for experiment in experiments:
        check_signals(experiment.input, experiment.outputs, experiment.output_names, experiment.name)
        if experiment.output_names != experiments[0].output_names:
            raise BadInputError("has other outputs than the first experiment", where=experiment.name)
    low, high, notes = _band(experiments, from_hz, to_hz, where)
    frf = _by_method(experiments, low, high, method, points, window_s)
    notes += [note for experiment in experiments for note in experiment.notes]
    notes += check_coherence(
        frf.frequency_hz,
        frf.coherence,
        frf.outputs,
        least=_LEAST_COHERENCE,
        allowed_share=_ALLOWED_LOW_SHARE,
        where=where,
    )
    return replace(frf, input_hold_s=experiments[0].hold_s, notes=tuple(dict.fromkeys([*frf.notes, *notes])))


def _band(
    experiments: Sequence[Experiment], from_hz: float | None, to_hz: float | None, where: str
) -> tuple[float, float, list[str]]:
    """The band to use, and notes where it is narrower than asked by default."""
    longest = max(e.duration_s for e in experiments)
    step = max(e.sample_time_s for e in experiments)
    low, high = from_hz or DEFAULT_BAND_HZ[0], to_hz or DEFAULT_BAND_HZ[1]
    frequency, density = _input_density(experiments, 0.5 * low, min(2 * high, 0.5 / step))
    notes = []
    if frequency.size < 8:
        check_length(longest, step, low, high, where)
        raise UnfitDataError("too_short", f"{longest:.3g} s are too short", where=where, fix="record longer")
    if from_hz is None or to_hz is None:
        edges, excited = excited_bands(frequency, density)
        used = np.flatnonzero(excited & (edges[1:] > low) & (edges[:-1] < high))
        if used.size == 0:
            raise UnfitDataError(
                "no_excitation", f"the input has nothing in {low:g}-{high:g} Hz", where=where
            )
        if from_hz is None:
            low = max(low, float(edges[used[0]]), LEAST_PERIODS / longest)
        if to_hz is None:
            high = min(high, float(edges[used[-1] + 1]), 0.25 / step)
        if (low, high) != DEFAULT_BAND_HZ and high > low:
            notes.append(f"band {low:.3g}-{high:.3g} Hz: what the input excites and the record resolves")
    if not 0 < low < high:
        raise BadInputError(f"the band runs from {low:g} to {high:g} Hz", fix="give --from-hz below --to-hz")
    check_length(longest, step, low, high, where)
    check_excitation(frequency, density, low, high, where)
    return low, high, notes


def _input_density(
    experiments: Sequence[Experiment], low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and amplitude densities of all inputs together, between two frequencies."""
    parts = []
    for e in experiments:
        count = len(e.input)
        frequency = np.fft.rfftfreq(count, e.sample_time_s)
        spectrum = np.fft.rfft(e.input - np.mean(e.input))
        inside = (frequency >= low) & (frequency <= high) & (frequency > 0)
        scale = e.sample_time_s / np.sqrt(count * e.sample_time_s)
        parts.append((frequency[inside], np.abs(spectrum[inside]) * scale))
    frequency = np.concatenate([f for f, _ in parts])
    order = np.argsort(frequency, kind="stable")
    return frequency[order], np.concatenate([d for _, d in parts])[order]


def _by_method(
    experiments: Sequence[Experiment],
    low: float,
    high: float,
    method: Method,
    points: int,
    window_s: float | None,
) -> FrequencyResponse:
    if method in ("h1", "h2", "hv"):
        _same_step(experiments)
        return averaged_spectra(experiments, low, high, estimator=method, window_s=window_s)
    if method != "lpm":
        period = _common_period(experiments)
        if period is not None and (method == "periodic" or _sparse(experiments[0], period, low, high)):
            return best_linear_approximation(experiments, period, low, high)
        if method == "periodic":
            raise UnfitDataError(
                "too_short", "the input does not repeat, or not equally in all experiments",
                where=experiments[0].name, fix="record at least two periods, or use another method",
            )  # fmt: skip
    lines = [fourier_lines(e, 0.0, high * 1.3) for e in experiments]
    joint = method == "auto" and all(_reference_excites(line, low, high) for line in lines)
    names = experiments[0].output_names
    return local_polynomial(lines, names, low, high, points=points, joint=joint)


def _same_step(experiments: Sequence[Experiment]) -> None:
    steps = [e.sample_time_s for e in experiments]
    if max(steps) > min(steps) * 1.001:
        raise BadInputError(
            f"sample times from {min(steps):g} to {max(steps):g} s cannot be averaged", fix="use --method lpm"
        )


def _common_period(experiments: Sequence[Experiment]) -> int | None:
    periods = {period_samples(e.input) for e in experiments}
    steps = [e.sample_time_s for e in experiments]
    if len(periods) != 1 or max(steps) > min(steps) * 1.001:
        return None
    return periods.pop()


def _sparse(experiment: Experiment, period: int, low: float, high: float) -> bool:
    """Few lines: neighbours say little about each other, so periods are the better judge of noise."""
    lines = excited_lines(experiment.input, period, experiment.sample_time_s, low, high)
    return 0 < lines <= _MOST_PERIODIC_LINES and experiment.kind != "chirp"


def _reference_excites(lines: Lines, low: float, high: float) -> bool:
    """Whether a recorded reference carries power over the whole band, as the input does."""
    if lines.reference is None:
        return False
    inside = (lines.frequency_hz >= low) & (lines.frequency_hz <= high)
    level = np.abs(lines.reference[inside])
    if np.max(level, initial=0.0) <= 1e-9:
        return False
    edges, excited = excited_bands(lines.frequency_hz[inside], level)
    return bool(np.mean(excited) > _REFERENCE_SHARE and len(edges) > 2)
