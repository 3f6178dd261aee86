"""Lines of a spectrum that keep their frequency, told from orders, which move with the wheel's speed.

A limit cycle of a control loop has the frequency of the loop, whatever the speed; what a joint or a tyre
excites has a multiple of the wheel's. Over time a cycle is one sharp line, and an order is smeared; over the
wheel's angle it is the other way round. The sharper one is the true one (order tracking by angular
resampling: Fyfe and Munck, Analysis of computed order tracking, MSSP 11(2), 1997).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from test_plans.conductor import Array
from test_plans.metrics._periodogram import without_trend

DECAYS = 0.7  # a line that has this share left at the end decays
_PERIODS = 3  # that make an oscillation
_PEELED = 12  # lines that are looked at, strongest first, at most
_LEAST_SHARE = 0.02  # of the largest value: smaller lines are not looked at
_TAIL = 10  # the part at the end that counts
_FINER = 4  # lines of the spectra between those of the window
_LEAST_TURNING = 0.05  # periods, rms, by which an order must leave a constant frequency, to be told from it
_ENDS, _GROWS = 5, 1.3  # parts of the window, and what grows from the first to the last
HIGHEST_ORDER = 6.5  # of a tripod joint (3, 6), an imbalance (1) and the first of a tyre
_SHARPER = 1.05  # what lives for a moment only is as sharp over time as over angle
_SMOOTHED_S, _SMOOTHED_SHARE = 1.0, 0.2  # over which a line's amplitude is taken
_LOWEST_PERIODS = 3.0  # of a line within the window


@dataclass(frozen=True)
class Line:
    """Amplitude in the signal's unit, and frequency."""

    amplitude: float
    frequency_hz: float


def lasting_oscillation(values: Array, spacing_s: float, turns_hz: Array) -> Line:
    """What swings at the end of a signal and follows no order of the wheel: a cycle, or what has grown.

    Args:
        values: shape (n,), every `spacing_s`.
        turns_hz: the wheel's revolutions a second at the same samples, shape (n,) or nearly.

    Returns:
        √2 times the rms of the last tenth without orders, which is a sine's amplitude, and its frequency.
    """
    count = len(values)
    time: Array = spacing_s * np.arange(count, dtype=float)
    turns = np.interp(np.linspace(0, 1, count), np.linspace(0, 1, len(turns_hz)), turns_hz)
    angle: Array = np.zeros(count)
    angle[1:] = spacing_s * np.cumsum(0.5 * (turns[1:] + turns[:-1]))
    left = without_trend(values)
    unexplained: Array = left.copy()
    least = _LEAST_SHARE * float(np.max(np.abs(left)))
    for _ in range(_PEELED):
        over_time = _sharpest(left, time)
        if over_time.amplitude <= least:
            break
        over_angle = _sharpest(left, angle) if np.min(turns) > 0.0 else Line(0.0, 0.0)
        along: Array = over_angle.frequency_hz * angle
        size, line = _followed(left, along, spacing_s)
        follows = _is_order(over_time, over_angle, _turning(along, size, time), size)
        if not follows:
            _, line = _followed(left, over_time.frequency_hz * time, spacing_s)
        left = left - line
        unexplained = unexplained - line if follows else unexplained
    tail = slice(count - max(2, count // _TAIL), count)
    amplitude = float(np.sqrt(2.0) * np.std(unexplained[tail]))
    return Line(amplitude, _sharpest(unexplained[tail], time[tail]).frequency_hz)


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


def _sharpest(values: Array, over: Array) -> Line:
    """The strongest line over time (s, then in Hz) or over angle (revolutions, then in orders).

    `over` rises; it need not be even. Lines of fewer than three periods belong to the trend.
    """
    even = np.linspace(over[0], over[-1], len(over))
    taper = _taper(len(even))
    resampled = np.interp(even, over, values) * taper
    size = 2.0 / float(np.sum(taper)) * np.abs(np.fft.rfft(resampled, _FINER * len(even)))
    frequency = np.fft.rfftfreq(_FINER * len(even), float(even[1] - even[0]))
    size[frequency * float(even[-1] - even[0]) < _LOWEST_PERIODS] = 0.0
    place = int(np.argmax(size))
    return Line(float(size[place]), float(frequency[place]))


def _taper(count: int) -> Array:
    """Rises over half the window and falls over its last twentieth: what has grown at the end is seen."""
    rising, falling = count // 2, max(2, count // 20)
    taper = np.ones(count)
    taper[:rising] = 0.5 - 0.5 * np.cos(np.pi * np.arange(rising) / rising)
    taper[count - falling :] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(falling) + 1) / falling)
    return taper


def _is_order(over_time: Line, over_angle: Line, turning: Array, size: Array) -> bool:
    """Whether the strongest line follows the wheel.

    Where the wheel's speed hardly changes while the line lasts, nothing in it tells an order from a cycle.
    There it is one if it is as low as those of joints and tyres are, and does not grow.

    Args:
        over_time: the strongest line over time.
        over_angle: the strongest line over the wheel's angle.
        turning: how far the phase of `over_angle` leaves a constant frequency at each sample, in periods,
            weighted by its power, shape (n,).
        size: its amplitude at each sample, shape (n,).
    """
    if over_angle.amplitude == 0.0:
        return False
    if float(np.sqrt(np.mean(turning**2))) < _LEAST_TURNING:
        part = max(1, len(size) // _ENDS)
        grows = float(np.mean(size[-part:])) > _GROWS * float(np.mean(size[:part]))
        return over_angle.frequency_hz <= HIGHEST_ORDER and not grows
    return over_angle.amplitude > _SHARPER * over_time.amplitude


def _turning(place: Array, size: Array, time: Array) -> Array:
    """How far a phase (periods) leaves its best straight line, weighted by the power of its line."""
    weight = size**2 / max(float(np.mean(size**2)), 1e-300)
    around = time - float(np.mean(weight * time))
    slope = float(np.mean(weight * around * place)) / max(float(np.mean(weight * around**2)), 1e-300)
    return np.asarray(np.sqrt(weight) * (place - float(np.mean(weight * place)) - slope * around))


def _followed(values: Array, periods: Array, spacing_s: float) -> tuple[Array, Array]:
    """Amplitude, smoothed over a second at most, and the line whose phase is `periods` (1: a whole turn)."""
    turning: npt.NDArray[np.complex128] = np.exp(-2j * np.pi * periods)
    length = max(3, round(min(_SMOOTHED_S, _SMOOTHED_SHARE * len(values) * spacing_s) / spacing_s))
    kernel = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length)
    size = 1 << int(len(values) + length - 1).bit_length()

    def smoothed(signal: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
        product = np.fft.fft(signal, size) * np.fft.fft(kernel, size)
        whole = np.fft.ifft(product)[: len(signal) + length - 1]
        return np.asarray(whole[(length - 1) // 2 :][: len(signal)])

    weight = smoothed(np.ones(len(values), complex)).real
    envelope = 2.0 * smoothed(values * turning) / np.maximum(weight, 1e-12)
    return np.abs(envelope), np.asarray((envelope * np.conj(turning)).real)
