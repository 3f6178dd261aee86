"""Lines of a spectrum that keep their frequency, told from orders, which move with the wheel's speed.

A limit cycle of a control loop has the frequency of the loop, whatever the speed; what a joint or a tyre
excites has a multiple of the wheel's. Over several windows in which the speed changes the two part.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from test_plans.conductor import Array

MOST_WINDOWS = 8
_SHORTEST_WINDOW_S = 0.2
_HALF_WIDTH = 2  # lines to each side that a line through a Hann window fills
_NARROW = 1  # lines to each side in which a line is followed, to tell whether it moves
_LEAST_MOTION = 1.5  # lines: by less nobody can tell an order from a line that keeps its frequency
_PEELED = 24  # orders and decaying lines that are taken away before what is left counts, at most
DECAYS = 0.7  # a line that has this share left at the end decays
_PERIODS = 3  # that make an oscillation


@dataclass(frozen=True)
class Line:
    """Amplitude in the signal's unit, and frequency."""

    amplitude: float
    frequency_hz: float


def strongest_cycle(values: Array, spacing_s: float, turns_hz: Array, declared: Sequence[float] = ()) -> Line:
    """The strongest line that keeps its frequency and does not decay.

    Args:
        values: shape (n,), every `spacing_s`.
        turns_hz: the wheel's revolutions a second at the same samples, shape (n,) or nearly.
        declared: orders of the wheel that do not count where the speed says nothing.
    """
    duration_s = len(values) * spacing_s
    windows = max(1, min(MOST_WINDOWS, int(duration_s / max(_SHORTEST_WINDOW_S, 1e-9))))
    frequency, spectra = _spectra(values, spacing_s, windows)
    turns = np.array([float(np.mean(part)) for part in np.array_split(turns_hz, windows)])
    taken = np.zeros(spectra.shape, bool)
    taken[:, : _HALF_WIDTH + 1] = True  # the trend's
    for _ in range(_PEELED):
        left = np.where(taken, 0.0, spectra)
        place = int(np.argmax(left[-1]))
        if left[-1, place] <= 0.0:
            break
        at = _refined(frequency, left[-1], place)
        steady = _amplitudes(left, np.full(windows, at / frequency[1]))
        order = at / turns[-1] if abs(turns[-1]) > 1e-3 else 0.0
        places = np.abs(order * turns) / frequency[1]
        if _is_order(left, at / frequency[1], places, order, declared):
            _take(taken, places)
        elif steady[-1] < DECAYS * steady[0]:
            _take(taken, np.full(windows, at / frequency[1]))
        else:
            return Line(float(steady[-1]), at)
    return Line(0.0, 0.0)


@dataclass(frozen=True)
class Swings:
    """Half the distance between a peak and the trough after it, of the first and the last such pair."""

    frequency_hz: float
    first: float
    last: float


def swings(values: Array, spacing_s: float) -> Swings | None:
    """The oscillation of a signal around its own mean; None with less than three periods."""
    around = values - np.mean(values)
    crossings = np.flatnonzero(np.diff(np.sign(around)) != 0)
    halves = [around[a : b + 1] for a, b in itertools.pairwise(crossings)]
    extremes = [float(np.max(np.abs(half))) for half in halves]
    if not extremes:
        return None
    largest = max(extremes)
    firm = [place for place, size in enumerate(extremes) if size > 0.1 * largest]  # noise crosses zero too
    if len(firm) < 2 * _PERIODS:
        return None
    length_s = (crossings[firm[-1] + 1] - crossings[firm[0]]) * spacing_s
    first = 0.5 * (extremes[firm[0]] + extremes[firm[1]])
    last = 0.5 * (extremes[firm[-2]] + extremes[firm[-1]])
    return Swings(0.5 * len(firm) / float(length_s), first, last)


def _spectra(values: Array, spacing_s: float, windows: int) -> tuple[Array, Array]:
    """Frequencies in Hz, shape (m,), and amplitudes of the lines in each window, shape (windows, m)."""
    length = len(values) // windows
    taper = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    position = np.arange(length) - 0.5 * (length - 1)
    found = []
    for number in range(windows):
        part = values[number * length : (number + 1) * length]
        slope = float(position @ (part - np.mean(part))) / max(float(position @ position), 1e-300)
        found.append(np.abs(np.fft.rfft((part - np.mean(part) - slope * position) * taper)))
    scale = 2.0 / float(np.sum(taper))
    return np.asarray(np.fft.rfftfreq(length, spacing_s)), scale * np.array(found)


def _amplitudes(spectra: Array, places: Array, half_width: int = _HALF_WIDTH) -> Array:
    """Amplitude of a line in each window, `places` in lines: what it fills there, taken together."""
    count = spectra.shape[1]
    found = np.zeros(len(spectra))
    for window, place in enumerate(places):
        first = max(0, round(float(place)) - half_width)
        part = spectra[window, min(first, count) : min(count, first + 2 * half_width + 1)]
        found[window] = np.sqrt(np.sum(part**2) / 1.5)  # a Hann window spreads a line over 1.5 lines' power
    return found


def _is_order(spectra: Array, place: float, places: Array, order: float, declared: Sequence[float]) -> bool:
    """Whether a line follows the wheel; where the speed hardly changes only a declaration can say.

    Args:
        spectra: amplitudes in each window, shape (windows, m).
        place: the line that keeps its frequency, in lines.
        places: the line that follows the wheel, in lines, shape (windows,).
    """
    if np.ptp(places) < _LEAST_MOTION:
        return any(
            abs(order / one - round(order / one)) * one < 0.1 and order > 0.5 * one for one in declared
        )
    steady = _amplitudes(spectra, np.full(len(places), place), _NARROW)
    following = _amplitudes(spectra, places, _NARROW)
    return bool(np.sum(np.log(following + 1e-12)) > np.sum(np.log(steady + 1e-12)))


def _take(taken: np.ndarray, places: Array) -> None:
    for window, place in enumerate(places):
        first = round(float(place)) - 2 * _HALF_WIDTH
        taken[window, max(0, first) : max(0, first + 4 * _HALF_WIDTH + 1)] = True


def _refined(frequency: Array, spectrum: Array, place: int) -> float:
    """Frequency of a line between the lines: their mean, weighted by power."""
    near = slice(max(0, place - 1), place + 2)
    power = spectrum[near] ** 2
    return float(frequency[near] @ power / np.sum(power))
