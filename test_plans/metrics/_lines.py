"""What a signal still swings by once the declared orders of the wheel are taken away.

A limit cycle of a control loop has the frequency of the loop. What a joint, a tyre or an imbalance
excites has a declared multiple of the wheel's revolutions, and is followed along the wheel's angle (order
tracking: Fyfe and Munck, Analysis of computed order tracking, MSSP 11(2), 1997).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from test_plans.conductor import Array
from test_plans.metrics._periodogram import without_trend

DECAYS = 0.7  # a line that has this share left at the end decays
_PERIODS = 3  # that make an oscillation
_BLOCK_S, _LEAST_BLOCKS = 0.5, 4  # in which lines are looked for
_FINER = 16  # lines of the spectra between those of the window
_LOWEST_PERIODS, _IN_BLOCK = (
    1.25,
    2.0,
)  # of a line, in all of the signal and in a block: slower is the trend's
_FOLLOWED_S = 2.0  # over which an order's amplitude is taken, where the signal is as long
_LEAST_TURNS = 2.0  # of an order in that time: slower ones are no ripple that could be followed


@dataclass(frozen=True)
class Line:
    """Amplitude in the signal's unit, and frequency."""

    amplitude: float
    frequency_hz: float


def lasting_line(values: Array, spacing_s: float) -> Line:
    """The strongest line that lasts, or is there at the end.

    Lines are looked for in the whole signal, which shows slow ones, and in blocks of half a second, which
    show how they come and go. What decays has gone in half of the blocks; what lasts is there in half of
    them, whatever happens then; what grows is there in the last.

    Args:
        values: shape (n,), every `spacing_s`.
    """
    length = min(round(_BLOCK_S / spacing_s), len(values) // _LEAST_BLOCKS)
    starts = range(len(values) - length, -1, -max(1, length // 2))
    blocks = [_strongest(values[start : start + length], spacing_s, _IN_BLOCK) for start in starts]
    median = sorted(blocks, key=lambda line: line.amplitude)[len(blocks) // 2]
    found = [_strongest(values, spacing_s, _LOWEST_PERIODS), blocks[0], median]
    return max(found, key=lambda line: line.amplitude)


def without_orders(values: Array, spacing_s: float, turns_hz: Array, orders: Iterable[float]) -> Array:
    """A signal without its linear trend and without declared orders, of shape (n,).

    Args:
        values: shape (n,), every `spacing_s`.
        turns_hz: the wheel's revolutions a second at the same samples, shape (n,) or nearly.
        orders: multiples of the wheel's revolutions.
    """
    count = len(values)
    turns = np.interp(np.linspace(0, 1, count), np.linspace(0, 1, len(turns_hz)), turns_hz)
    angle: Array = np.zeros(count)
    angle[1:] = spacing_s * np.cumsum(0.5 * (turns[1:] + turns[:-1]))
    left = without_trend(values)
    followed_s = min(_FOLLOWED_S, count * spacing_s)
    for order in orders:
        turning = np.abs(order * turns) * followed_s >= _LEAST_TURNS
        left = left - np.where(turning, _followed(left, order * angle, round(followed_s / spacing_s)), 0.0)
    return left


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


def _strongest(values: Array, spacing_s: float, lowest_periods: float) -> Line:
    """The strongest line of a signal, linear trend removed, Hann window."""
    count = len(values)
    taper = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(count) + 0.5) / count)
    lines = np.abs(np.fft.rfft(without_trend(values) * taper, _FINER * count))
    frequency = np.fft.rfftfreq(_FINER * count, spacing_s)
    lines[frequency * count * spacing_s < lowest_periods] = 0.0
    place = int(np.argmax(lines))
    return Line(float(2.0 * lines[place] / np.sum(taper)), float(frequency[place]))


def _followed(values: Array, periods: Array, length: int) -> Array:
    """The line whose phase is `periods` (1: a whole turn), its amplitude smoothed over `length` samples."""
    turning: npt.NDArray[np.complex128] = np.exp(-2j * np.pi * periods)
    kernel = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length)
    size = 1 << int(len(values) + length - 1).bit_length()

    def smoothed(signal: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
        product = np.fft.fft(signal, size) * np.fft.fft(kernel, size)
        whole = np.fft.ifft(product)[: len(signal) + length - 1]
        return np.asarray(whole[(length - 1) // 2 :][: len(signal)])

    weight = smoothed(np.ones(len(values), complex)).real
    envelope = 2.0 * smoothed(values * turning) / np.maximum(weight, 1e-12)
    return np.asarray((envelope * np.conj(turning)).real)
