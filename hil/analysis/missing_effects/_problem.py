"""Errors of hypotheses on all recordings, and how they change with every number."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._hypothesis import Coordinate, Hypothesis
from hil.analysis.missing_effects._noise import colour_of, with_motion
from hil.analysis.missing_effects._series import Series, block_means
from hil.analysis.missing_effects._simulations import UNBOUNDED, Allowance, Shown
from hil.analysis.missing_effects._spectrum import RIGHT_TO, Powers, Spectrum, of_noise, powers_of
from hil.core.model import Model, TransferFunction
from hil.core.runtime.thread_map import map_on_threads
from hil.plant import SENSOR_TURNED, Led, begins_of, gear_ratio_of, is_regulated, pack, simulate_many, turns

Array = npt.NDArray[np.float64]
_Result = TypeVar("_Result")

_BEHIND_WHEELS = frozenset({"wheel_inertia", "tyre_stiffness", "tyre_damping", "vehicle_inertia"})
SLOW_NOISE = 1.2
"""Times its white noise may a sensor's error be where its slow noise is not proven."""
STATES = 5  # of a start: motor speed, wheel speed, shaft torque, and two of a motion inside the tyre
_FAR = 1e9  # a simulation that runs away is so many standard deviations off, not infinitely many
_WINDOWS = 12  # at least, by which noise is told
_STILL = (0.25, 0.1)  # of them have that share of the mean power of the torque, in most octaves
_RANK = 1e-7  # smallest singular value of a start's sensitivities that counts, of the largest


@dataclass(frozen=True)
class Problem:
    """What is to be explained: a base model and recordings.

    `noise` (3,) is a standard deviation, `signal` (3,) a mean square of each channel, `spectrum` is what
    errors are weighed by; `scales` are sizes of numbers that may be zero, `held` numbers without effect.
    `colour` (3 x bands) is that of noise, None where it is white; `tells_noise` whether the torque differs so
    much between windows that what all of them show is noise. Of a base that is `far` off as a whole only a
    count of teeth says something. Where `led_s` is not 0, recorded speeds lead each simulation within that
    time. Every simulation asks `allowance` first.
    """

    model: Model
    series: tuple[Series, ...]
    noise: Array
    spectrum: Spectrum
    signal: Array
    scales: dict[str, float] = field(default_factory=dict)
    held: frozenset[str] = frozenset()
    angles: tuple[Array, ...] = ()
    colour: Array | None = None
    tells_noise: bool = False
    far: bool = False
    led_s: float = 0.0
    shown: Shown = field(default_factory=Shown, repr=False, compare=False)
    allowance: Allowance = UNBOUNDED

    def weighed_by(self, spectrum: Spectrum) -> Problem:
        """The same, errors weighed by another spectrum."""
        return replace(self, spectrum=spectrum)

    def weighed_as(self, errors: Sequence[Array], *, once: bool = False) -> Problem:
        """The same, errors weighed by the spectrum of such errors.

        Args:
            once: what a torque that repeats itself shows again and again counts once, as in odds and errors.
        """
        return self.weighed_by(self.powers(errors, once=once).spectrum(self.noise))

    def weighed_by_noise(self) -> Problem:
        """The same, errors weighed by noise alone."""
        return self.weighed_by(of_noise(self.noise, self.rate_hz, self.colour))

    def coordinates(self, hypothesis: Hypothesis) -> list[Coordinate]:
        """Free numbers of a hypothesis: a gear ratio is one where the wheel side was recorded."""
        return [
            replace(one, base=None) if self.far and one.term < 0 and one.name != "gear_ratio" else one
            for one in hypothesis.coordinates(self.scales)
            if one.term >= 0 or one.name not in self.held
        ]

    @cached_property
    def as_it_came(self) -> Hypothesis:
        """The base with its own numbers."""
        return Hypothesis.alone(self.model)

    @property
    def functions(self) -> dict[str, TransferFunction] | None:
        """Of a transfer-function model; None of a chain."""
        return self.model.transfer_functions or None

    @property
    def rate_hz(self) -> float:
        """Of errors."""
        return self.series[0].rate_hz

    @property
    def slow_noise(self) -> float:
        """Largest variance of block means that may be noise, in that of white noise."""
        return 1.0 + self.samples_in_a_mean * (SLOW_NOISE**2 - 1.0)

    @property
    def samples_in_a_mean(self) -> float:
        """Of errors: recordings of other rates have others."""
        return float(np.median([one.block for one in self.series]))

    def noise_in(self, errors: Sequence[Array]) -> tuple[Array, Array]:
        """Mean square that is noise beyond doubt, (3,), and the most that may be noise.

        What quiet windows show as well; where all windows are alike white noise, and what is usual. No less
        than what no model is right to.
        """
        return self._noise_in(self.powers(errors))

    def _noise_in(self, powers: Powers) -> tuple[Array, Array]:
        most = self.slow_noise * self.noise**2
        if not self.tells_noise:
            return self.noise**2, np.maximum(most, self._right)
        level, upper = (powers.mean_square(one) for one in powers.quiet(self.noise))
        upper = np.minimum(upper, most)
        level = np.maximum(2.0 * np.minimum(level, most) - upper, self.noise**2)
        return level, np.maximum(upper, self._right)

    def slowest_noise(self, errors: Sequence[Array]) -> Array:
        """Power of noise in the lowest octave, (3,), which an integral of a speed sees."""
        if not self.tells_noise:
            return self.noise**2
        return np.asarray(self.powers(errors).quiet(self.noise)[0, :, 0])

    def most_to_gain(self, errors: Sequence[Array]) -> float:
        """Growth of log L if no more than noise stayed in any octave."""
        powers = self.powers(errors)
        stays = powers.quiet(self.noise)[1] if self.tells_noise else np.zeros(1)
        return powers.most_to_gain(self.noise, stays)

    def is_noise(self, errors: Sequence[Array]) -> bool:
        """Whether errors are at most what is proven, or usual for slow noise."""
        powers = self.powers(errors)
        square = powers.mean_square()
        there = np.isfinite(square)
        return bool(np.all(square[there] <= self._noise_in(powers)[1][there]))

    def is_right(self, errors: Sequence[Array]) -> bool:
        """Whether errors beyond noise are no more than what no model is right to: nothing is to be named."""
        square = self.mean_square(errors)
        there = np.isfinite(square)
        return bool(np.all(square[there] <= self._right[there]))

    @property
    def _right(self) -> Array:
        """Mean square of errors of a model that is as right as one can be, (3,)."""
        return self.noise**2 + RIGHT_TO**2 * self.signal

    def powers(self, errors: Sequence[Array], *, once: bool = False) -> Powers:
        """Of errors of each recording, where they count.

        Args:
            once: what a torque that repeats itself shows again and again counts once.
        """
        lowest = [one.lowest_hz for one in self.series]
        periods = [one.periods if once else 1.0 for one in self.series]
        return powers_of(errors, self.rate_hz, self.signal, lowest, periods, self.colour)

    def mean_square(self, errors: Sequence[Array]) -> Array:
        """Of each channel over all that counts of the recordings, (3,); NaN where it was not recorded."""
        return self.powers(errors).mean_square()

    def first_states(self) -> list[Array]:
        """A first guess of each recording's start."""
        ratio = gear_ratio_of(self.model) or 1.0
        return [one.first_state(ratio) for one in self.series]

    def each(self, function: Callable[[int], _Result]) -> list[_Result]:
        """A function of each recording's index, side by side on threads.

        Raises:
            OutOfTimeError: the search has taken what it may.
        """
        self.allowance.check()
        return map_on_threads(function, range(len(self.series)))

    def simulated(
        self, index: int, packed: Sequence[tuple[Array, Array]], starts: Array, *, keep: bool = True
    ) -> Array:
        """Channels of a recording by several models: sets x blocks x 3.

        One that runs away is far off, not missing: it would be the likeliest of all.

        Args:
            keep: whether the same may be asked for again. What comes back is not to be written to.
        """
        one, angles = self.series[index], self.angles[index]
        slots, sensors = np.stack([p[0] for p in packed]), self.sensors(index, [p[1] for p in packed])
        begins = starts if self.functions else begins_of(slots, starts)
        keys = [
            (
                id(one),
                id(angles) if follows else 0,
                p.tobytes(),
                sensor.tobytes(),
                begin.tobytes(),
                self.led_s,
            )
            for p, sensor, begin, follows in zip(slots, sensors, begins, turns(slots).tolist(), strict=True)
        ]

        led = Led(one.samples[:, :2], -math.expm1(-one.dt / self.led_s)) if self.led_s else None

        def simulate(some: npt.NDArray[np.int64]) -> Array:
            shown = simulate_many(
                slots[some], one.torque, one.dt, begins[some], sensors[some], one.block, angles, one.load,
                self.functions, led=led,
            )  # fmt: skip
            return _bounded(shown)

        return self.shown.outputs(keys, simulate, (one, angles), keep=keep)

    def sensors(self, index: int, packed: Sequence[Array]) -> Array:
        """Of sets (each 3 x numbers), as a recording has their channels: of an angle what that turns by."""
        sensors = np.stack(packed)
        sensors[:, :, SENSOR_TURNED] = self.series[index].turned_over_s
        return sensors

    def samples(self, index: int, hypothesis: Hypothesis, start: Array) -> Array:
        """Channels of a recording by a hypothesis at every sample, n x 3."""
        one = self.series[index]
        slots, sensor = hypothesis.packed()
        angles = self.angles[index]
        shown = simulate_many(
            slots[None], one.torque, one.dt, start[None], self.sensors(index, [sensor]), 1, angles, one.load,
            self.functions,
        )  # fmt: skip
        return np.asarray(shown[0])

    def errors(self, hypothesis: Hypothesis, starts: Sequence[Array]) -> list[Array]:
        """Measured less simulated of each recording, blocks x 3; NaN where a channel was not recorded."""
        packed = [hypothesis.packed()]
        return self.each(lambda i: self.series[i].measured - self.simulated(i, packed, starts[i][None])[0])

    def weighed(self, index: int, values: Array) -> Array:
        """sets x blocks x 3 as weighed transforms, sets x numbers: half the squares add to -log L.

        The first block of each channel stands behind them, weighed by noise alone: a discrepancy is what a
        model gathers on its way, so that a recording begins where it was measured to.
        """
        one = self.series[index]
        seen = _bounded(values if one.has.all() else values[..., one.has])
        first = seen[:, 0] / self.noise[one.has]
        beginning = np.concatenate([self.spectrum.rising(seen, one.has, one.rate_hz), first], axis=1)
        room = beginning.shape[1]
        numbers = self.spectrum.weighed(seen, one.has, one.rate_hz, one.lowest_hz, room)
        numbers[:, -room:] = beginning
        return numbers

    def by_octave(self, index: int, rows: Array) -> tuple[Array, Array]:
        """Products of rows of `weighed` numbers with each other: 3 x bands x rows x rows, and of the rest."""
        one = self.series[index]
        return self.spectrum.by_octave(rows, one.has, len(one.measured), one.rate_hz)

    def start_basis(self, index: int, hypothesis: Hypothesis, start: Array) -> tuple[Array, Array]:
        """Moves of a recording's start (states x k) that take an orthonormal basis off weighed errors.

        The basis (numbers x k) holds all that a start can change of them.
        """
        one = self.series[index]
        speed = max(float(np.nanmax(np.abs(one.samples[:, :2]))) if one.has[:2].any() else 1.0, 1e-6)
        torque = max(float(np.max(np.abs(one.torque))), 1e-9)
        sizes = 1e-3 * np.array([speed, speed, torque, speed, speed / 100.0])
        sizes[:3][one.given] = 0.0
        starts = np.concatenate([start[None], start + np.diag(sizes)])
        shown = self.simulated(index, [hypothesis.packed()] * (STATES + 1), starts)
        change = self._changes(index, shown[1:] - shown[0])
        basis, values, axes = np.linalg.svd(change.T, full_matrices=False)
        rank = np.count_nonzero(values > _RANK * max(values[0], 1e-300))
        return sizes[:, None] * (axes[:rank] / values[:rank, None]).T, basis[:, :rank]

    def _changes(self, index: int, values: Array) -> Array:
        """As `weighed`; sets that change nothing cost nothing."""
        moved = np.array([one.any() for one in values], dtype=bool)
        if moved.all():
            return self.weighed(index, values)
        change = self.weighed(index, values[moved] if moved.any() else values[:1])
        whole = np.zeros((len(values), change.shape[1]))
        whole[moved] = change[: np.count_nonzero(moved)]
        return whole

    def derivatives(
        self,
        hypothesis: Hypothesis,
        starts: Sequence[Array],
        coordinates: Sequence[Coordinate],
        u: Array,
        wider: float = 1.0,
    ) -> list[Array]:
        """Derivatives of each recording's weighed errors by the coordinates (numbers x coordinates).

        Args:
            wider: times the usual finite differences.
        """
        steps = np.array([_step(one, at, wider) for one, at in zip(coordinates, u.tolist(), strict=True)])
        points = [u, *(u + np.diag(steps))]
        packed = [hypothesis.moved(coordinates, point).packed() for point in points]

        def slopes(index: int) -> Array:
            shown = self.simulated(index, packed, np.repeat(starts[index][None], len(points), axis=0))
            changes = self.weighed(index, shown[0] - shown[1:])
            changes /= steps[:, None]
            return changes.T

        return self.each(slopes)

    def prior(self, coordinates: Sequence[Coordinate], u: Array) -> Array:
        """Numbers of the base away from what it says: half the squares add to -log of a Cauchy density.

        A number is calibrated, or it may be anything: one of two explanations that moves fewer numbers is
        the likelier, while a base that is far off as a whole says nothing.
        """
        away = self._away(coordinates, u)
        return np.asarray(np.sign(away) * np.sqrt(2.0 * np.log1p(away**2)))

    def log_prior(self, hypothesis: Hypothesis) -> float:
        """Log density of a hypothesis' numbers, of which the base says something."""
        coordinates = self.coordinates(hypothesis)
        return -0.5 * float(np.sum(self.prior(coordinates, np.zeros(len(coordinates))) ** 2))

    def prior_slopes(self, coordinates: Sequence[Coordinate], u: Array) -> Array:
        """Derivatives of `prior`, on the diagonal."""
        away = np.abs(self._away(coordinates, u)) + 1e-9
        slopes = 2.0 * away / (1.0 + away**2) / np.sqrt(2.0 * np.log1p(away**2))
        return np.diag([s * one.away_slope() for s, one in zip(slopes, coordinates, strict=True)])

    def prior_chords(self, coordinates: Sequence[Coordinate], u: Array) -> Array:
        """Slopes of `prior` back to where a base's numbers would be right, on the diagonal."""
        away = np.abs(self._away(coordinates, u)) + 1e-9
        slopes = np.sqrt(2.0 * np.log1p(away**2)) / away
        return np.diag([s * one.away_slope() for s, one in zip(slopes, coordinates, strict=True)])

    @staticmethod
    def _away(coordinates: Sequence[Coordinate], u: Array) -> Array:
        return np.array([one.away(at) for one, at in zip(coordinates, u.tolist(), strict=True)], dtype=float)


def _bounded(values: Array) -> Array:
    """Values as they are, but for what runs away."""
    if not values.size or np.max(np.abs(values)) < _FAR:  # not NaN either
        return values
    return np.asarray(np.clip(np.nan_to_num(values, nan=_FAR), -_FAR, _FAR))


def _step(one: Coordinate, at: float, wider: float) -> float:
    """A finite difference that stays inside the bounds."""
    step = wider * one.step
    return step if one.at(at + step) <= one.upper else -step


def problem_of(
    model: Model, series: Sequence[Series], noise: Array, spectrum: Spectrum | None = None
) -> Problem:
    """The problem of a base model and recordings, errors weighed by noise where no spectrum is given."""
    ratio = gear_ratio_of(model) or 1.0
    colour = colour_of(series)
    if is_regulated(model):
        noise, colour = with_motion(noise, colour, series, pack(model))
    return Problem(
        model,
        tuple(series),
        noise,
        spectrum or of_noise(noise, series[0].rate_hz, colour),
        _signal(series),
        _scales(model, series),
        angles=tuple(one.angles(ratio) for one in series),
        colour=colour,
        held=_held(model, series),
        tells_noise=_tells_noise(series),
    )


def _tells_noise(series: Sequence[Series]) -> bool:
    """Whether the torque is still in some windows and not in others, in most octaves."""
    torques = [block_means(one.torque, one.block) for one in series]
    power = powers_of(torques, series[0].rate_hz, np.ones(1)).power[:, 0, 1:]
    low, mean = np.quantile(power, _STILL[0], axis=0), np.mean(power, axis=0)
    is_still = np.median(low / np.maximum(mean, 1e-300)) < _STILL[1]
    return bool(len(power) >= _WINDOWS and is_still)


def _held(model: Model, series: Sequence[Series]) -> frozenset[str]:
    """Numbers without effect: those behind wheels that turn as recorded, a gear to a side that was not."""
    if is_regulated(model):
        rigid = {"gear_ratio"} if model.kind == "rigid" else set()
        return (_BEHIND_WHEELS & model.parameters.keys()) | rigid
    return frozenset() if any(one.has[1:].any() for one in series) else frozenset({"gear_ratio"})


def _signal(series: Sequence[Series]) -> Array:
    """Mean square of each channel around its mean, 0 where it was not recorded; (3,)."""
    squares = [np.nan_to_num(np.var(one.measured, axis=0)) * len(one.measured) for one in series]
    counts = [one.has * len(one.measured) for one in series]
    return np.asarray(np.sum(squares, axis=0) / np.maximum(np.sum(counts, axis=0), 1))


def _scales(model: Model, series: Sequence[Series]) -> dict[str, float]:
    """Sizes of numbers that may be zero, from the data and the other numbers, not from their own values."""
    numbers = model.parameters
    torque = float(np.sqrt(np.mean([np.mean(one.torque**2) for one in series])))
    speeds = [np.nanmean(one.samples[:, 0] ** 2) for one in series if one.has[0]]
    speed = float(np.sqrt(np.mean(speeds))) if speeds else 1.0
    scales = {"torque_delay": series[0].dt, "viscous_drag": torque / max(speed, 1e-12)}
    load = numbers.get("wheel_inertia", numbers.get("vehicle_inertia", 1.0))
    for part in ("shaft", "tyre"):
        if f"{part}_stiffness" in numbers:
            scales[f"{part}_damping"] = 0.1 * float(np.sqrt(numbers[f"{part}_stiffness"] * load))
    return {name: size for name, size in scales.items() if name in numbers}
