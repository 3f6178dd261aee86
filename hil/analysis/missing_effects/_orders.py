"""Orders of turning in the misfit: which multiples of an angle a ripple would have to follow.

The slope of the cost by a ripple e^{j·order·angle} is the misfit sent back through the plant (its adjoint),
transformed over the measured angle in place of time; divided by the ripple's own energy behind the plant it
is the drop that each order promises. One transform gives all orders.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.fft import dct, idct

from hil.analysis.missing_effects._fit import Point
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._series import Series
from hil.analysis.missing_effects._spectrum import SEGMENT_S, Spectrum, bands_of, powers_of
from hil.core.runtime.compiled import compiled_without_lock
from hil.plant import gear_ratio_of, linear_system_of, turned

Array = npt.NDArray[np.float64]
Side = Literal["wheel", "rotor"]

_HIGHEST = 60.0  # order
_FINE = 0.02  # distance of orders that are looked at, at most
_OF_A_TURN = 0.25  # by which an order may be off over the longest recording: it would lose its phase
_BINS = 4  # of angle in a period of the highest order
PERIODS = 2.0
"""Of a ripple that a recording must hold."""
_ONCE, _HALF_TURN = (0.9, 1.1), 0.5  # order of gravity and imbalance, of which half a period does
_COUNT = 4
_SOURCES = {"wheel": "extra_shaft_torque_nm", "rotor": "rotor_loss_nm"}


def orders_of(problem: Problem, point: Point, side: Side) -> list[float]:
    """The most promising orders, by weights of the misfit and by those of noise; none where nothing turns.

    A ripple that is most of the misfit makes its own octaves weigh little.
    """
    by_noise = problem.weighed_by_noise()
    system = linear_system_of(point.hypothesis.packed()[0])
    fine = fineness(turns(problem, side))
    orders = np.arange(fine, _HIGHEST, fine)

    def seen(index: int) -> tuple[npt.NDArray[np.int64], list[_Seen]]:
        one, count = problem.series[index], len(point.errors[index])
        frequency: Array = np.fft.rfftfreq(count, 1.0 / one.rate_hz).astype(np.float64)
        response = np.zeros((3, len(frequency)), complex)
        fast = frequency > 1.0 / SEGMENT_S  # what is slower the starts of windows take up
        response[:, fast] = system.response(frequency[fast], _SOURCES[side])
        angle = problem.angles[index][: count * one.block, 0 if side == "wheel" else 1]
        angle = angle.reshape(count, one.block).mean(axis=1)
        speed = np.abs(np.gradient(angle)) * one.rate_hz / (2 * np.pi)
        # a ripple faster than errors are sampled must not look like a slow one
        finer = int(np.ceil(2.0 * _HIGHEST * np.max(speed) / one.rate_hz)) + 1
        at = np.interp(np.arange(count * finer) / finer, np.arange(count), angle)
        bins = bins_of(at, fine, len(orders))
        both = (problem.spectrum, by_noise.spectrum)
        errors = point.errors[index]
        return bins, [_seen(one, way, errors, response, len(bins), orders, speed, frequency) for way in both]

    bins, shown = zip(*problem.each(seen), strict=True)
    where, ways = np.concatenate(bins), list(zip(*shown, strict=True))
    sums = [
        np.bincount(where, np.concatenate([one.torque for one in way]), _BINS * len(orders)) for way in ways
    ]
    found: list[float] = []
    for way, slope in zip(ways, by_order(np.array(sums), len(orders)), strict=True):
        promise = np.abs(slope) ** 2 / np.maximum(np.sum([one.energy for one in way], axis=0), 1e-250)
        whole = sum(one.whole for one in way)
        promise[promise > whole] = 0.0  # more than there is: an order that the plant does not show
        promise[orders * turns(problem, side) < PERIODS] = 0.0
        found += peaks(orders, promise, _COUNT)
    return list(dict.fromkeys(found))


@dataclass(frozen=True)
class _Seen:
    """Of a recording, by one weighing: what a ripple of each order promises, and what there is.

    `torque` is that sent back, by finer blocks, `energy` that of each order's ripple behind the plant.
    """

    torque: Array
    energy: Array
    whole: float


def _seen(
    one: Series,
    spectrum: Spectrum,
    errors: Array,
    response: npt.NDArray[np.complex128],
    finer: int,
    orders: Array,
    speed_hz: Array,
    frequency: Array,
) -> _Seen:
    """Of errors (blocks x 3) and the response of all channels; the torque at so many finer blocks."""
    error = np.nan_to_num(errors[:, one.has])
    slope = spectrum.sent_back(error, one.has, one.rate_hz, one.lowest_hz)
    back = np.sum(np.conj(response[one.has]) * np.fft.rfft(slope, axis=0).T, axis=0)
    weight = spectrum.weights(len(errors), one.rate_hz, one.lowest_hz).T ** 2
    gain = np.sum((np.abs(response) ** 2 * weight)[one.has], axis=0)
    torque = np.asarray(np.fft.irfft(back, finer), dtype=float)
    return _Seen(torque, _energy(speed_hz, orders, frequency, gain), float(np.sum(error * slope)))


def turned_with(problem: Problem, point: Point) -> Problem:
    """The same, angles by the speeds of a point and by that of its misfit which is more than noise.

    An angle that is integrated from readings walks off with their noise, one that is simulated with what the
    model gets wrong: of each octave of a recording's difference a share (P - N)/P is taken (N. Wiener, 1949).
    """
    colour = 1.0 if problem.colour is None else problem.colour
    noise = problem.slow_noise * np.nan_to_num(problem.noise)[:, None] ** 2 * colour
    ratio = gear_ratio_of(point.hypothesis.model()) or 1.0
    angles = []
    for index, one in enumerate(problem.series):
        shown = problem.samples(index, point.hypothesis, point.starts[index])
        apart = dct(one.samples - shown, axis=0)  # no leap where a drift ends elsewhere than it began
        powers = powers_of([point.errors[index]], problem.rate_hz, problem.signal)
        power = np.mean(powers.power, axis=0)
        share = np.maximum(1.0 - noise / np.maximum(power, 1e-300), 0.0)
        band = bands_of(powers.edges_hz, np.arange(len(shown), dtype=np.float64) / (2 * len(shown) * one.dt))
        speeds = shown + idct(share.T[band] * apart, axis=0)
        angles.append(turned(speeds, one.dt, ratio, one.first_wheel_angle_rad))
    return replace(problem, angles=tuple(angles))


def count_of_orders(problem: Problem, side: Side) -> float:
    """How many orders the longest recording tells apart: among so many a ripple is looked for."""
    return _HIGHEST * turns(problem, side)


def turns(problem: Problem, side: Side) -> float:
    """Of wheel or rotor in the longest recording."""
    column = 0 if side == "wheel" else 1
    return max(float(np.ptp(both[:, column])) for both in problem.angles) / (2 * np.pi)


def is_held(order: Array, turned: float) -> npt.NDArray[np.bool_]:
    """Whether a recording of so many turns holds enough of a ripple to tell it from what is slow."""
    once = (order >= _ONCE[0]) & (order <= _ONCE[1]) & (turned >= _HALF_TURN)
    return np.asarray((order * turned >= PERIODS) | once)


def fineness(turned: float) -> float:
    """Distance of orders that are looked at in recordings of so many turns."""
    return min(_FINE, _OF_A_TURN / max(turned, 1e-9))


def over_angle(values: Array, angle: Array, fine: float, count: int) -> npt.NDArray[np.complex128]:
    """Σ values·e^{-j·order·angle} at orders `fine`, 2·`fine` …: angles modulo one period of the finest."""
    sums = np.bincount(bins_of(angle, fine, count), values, _BINS * count)
    return np.asarray(np.fft.rfft(sums)[1 : count + 1])


def bins_of(angle: Array, fine: float, count: int) -> npt.NDArray[np.int64]:
    """Where angles lie in one period of the finest order, in `_BINS` a period of the highest."""
    period, bins = 2 * np.pi / fine, _BINS * count
    return np.asarray(np.floor((angle % period) / period * bins).astype(np.int64) % bins)


def by_order(pairs: Array, count: int) -> npt.NDArray[np.complex128]:
    """Transforms of two sums by bins of angle (2 x bins) at so many orders: 2 x orders.

    One is the real part of what is transformed, the other the imaginary part.
    """
    both = np.fft.fft(pairs[0] + 1j * pairs[1])
    here, mirrored = both[1 : count + 1], np.conj(both[: -count - 1 : -1])
    return np.stack([0.5 * (here + mirrored), -0.5j * (here - mirrored)])


def _energy(speed_hz: Array, orders: Array, frequency: Array, gain: Array) -> Array:
    """Energy behind the plant of a ripple of each order, by how long it has each frequency."""
    levels = np.linspace(0.0, float(np.max(speed_hz, initial=0.0)), 65)
    share, _ = np.histogram(speed_hz, levels)
    middles = 0.5 * (levels[1:] + levels[:-1])
    total = np.zeros(len(orders))
    for count, middle in zip(share.tolist(), middles.tolist(), strict=True):
        if count:
            _add_between(total, count, orders[0] * middle / frequency[1], gain)
    return total


@compiled_without_lock
def _add_between(total, factor, step, values):  # type: ignore[no-untyped-def]
    """Add factor·values at `step`, 2·`step` …, straight between places 0, 1 …; beyond them nothing."""
    last = values.shape[0] - 1
    for k in range(total.shape[0]):
        at = (k + 1) * step
        if at > last:
            break
        place = min(int(at), last - 1)
        total[k] += factor * (values[place] + (at - place) * (values[place + 1] - values[place]))


def peaks(orders: Array, promise: Array, count: int) -> list[float]:
    """The most promising orders, well apart."""
    found: list[float] = []
    for at in np.argsort(promise)[::-1].tolist():
        if promise[at] <= 0.0 or len(found) == count:
            break
        if all(abs(orders[at] - other) > 0.2 for other in found):
            found.append(float(orders[at]))
    return found
