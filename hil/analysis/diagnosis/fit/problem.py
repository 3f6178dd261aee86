"""Weighted simulation errors of a hypothesis over all recordings, and their derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.noise import proven_noise
from hil.analysis.diagnosis.data.thresholds import LITTLE_TORQUE
from hil.analysis.diagnosis.data.trace import Flags, Trace
from hil.analysis.diagnosis.fit.allowance import UNBOUNDED, Allowance
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.normal import Normal, normal_equations
from hil.analysis.diagnosis.fit.thresholds import (
    DIVERGED,
    FINE,
    HUGE,
    LEAD_PART,
    LEAD_S,
    MID_MOTION,
    REST_SAMPLES,
    REST_SHARE,
    REST_SIGMAS,
    STEP,
)
from hil.core.model import TransferFunction
from hil.core.runtime.thread_map import map_on_threads
from hil.plant import simulate_many

Array = npt.NDArray[np.float64]

#: Initial values of each recording: motor speed, wheel speed, shaft torque, and where it begins in
#: mid-motion vehicle less wheel speed and the tyre's own twist.
STARTS = 5
MOTOR, WHEEL, SHAFT, VEHICLE, TYRE = range(STARTS)


@dataclass(frozen=True)
class Tried:
    """Points that were simulated: the sum of squared errors of each, and per recording what they showed.

    `rows` are points x rows, the errors; `shown` points x blocks x 3, the channels.
    """

    costs: Array
    rows: list[Array]
    shown: list[Array]


@dataclass(frozen=True)
class Linearised:
    """Sum of squared errors, and per recording its normal equations and errors."""

    cost: float
    normals: tuple[Normal, ...]
    errors: tuple[Errors, ...]


@dataclass(frozen=True, eq=False)
class Problem:
    """Recordings with the noise levels that weigh them (`noise`) and those of single readings (`floor`).

    `weights` are trace by trace (3,): what one block's error is multiplied by, 0 for a missing channel.
    `angles` (rad, samples x wheel and rotor) are what ripples follow, measured ones (`search` corrects
    them): a simulated angle drifts off as long as the model is not right, and takes the ripple's phase with
    it. `misfit` is the variance of an error, in noise variances, that weighs what is known beforehand of a
    model's numbers: beside errors a thousand times the noise it would say nothing, and what the recordings
    do not tell would run away. `proven` is the largest power, (3,), that noise may have in the weighed
    errors of each channel. Every simulation asks `allowance` first. `functions` are those of a
    transfer-function model. `zero_known` says that a recording from rest begins at the angle
    from which the base model's ripples count. A problem never changes: other angles make another one.
    """

    traces: tuple[Trace, ...]
    noise: Array
    floor: Array
    gear_ratio: float
    angles: tuple[Array, ...]
    weights: tuple[Array, ...]
    resting: tuple[bool, ...]
    proven: Array
    whitening: Array | None = None
    misfit: float = 1.0
    allowance: Allowance = UNBOUNDED
    functions: Mapping[str, TransferFunction] | None = None
    zero_known: bool = True

    @cached_property
    def channels(self) -> int:
        """How many channels any recording has."""
        return int(np.count_nonzero(np.any([t.has for t in self.traces], axis=0)))

    @cached_property
    def rows(self) -> int:
        """How many errors there are: what their squares sum up to where there is nothing but noise."""
        return int(sum(np.count_nonzero(t.has) * np.count_nonzero(t.judged_blocks) for t in self.traces))

    @cached_property
    def partial(self) -> bool:
        """Whether there are stretches in which errors do not count."""
        return any(t.judged is not None for t in self.traces)

    def judging(self, judged: Sequence[Flags]) -> Problem:
        """The same, errors counting only in these blocks of each recording."""
        traces = (replace(t, judged=flags) for t, flags in zip(self.traces, judged, strict=True))
        return replace(self, traces=tuple(traces))

    def judging_all(self) -> Problem:
        """The same, errors counting everywhere."""
        return replace(self, traces=tuple(replace(t, judged=None) for t in self.traces))

    def whitened(self, whitening: Array) -> Problem:
        """The same, errors filtered by `whitening` (3 x order + 1)."""
        return replace(self, whitening=read_only(whitening))

    def with_angles(self, angles: Sequence[Array]) -> Problem:
        """The same, ripples following other angles."""
        return replace(self, angles=tuple(angles))

    def following(self, hypothesis: Hypothesis, theta: Array) -> Problem:
        """The same, angles integrated anew from the speeds as the sensors of `hypothesis` read them."""
        sensors = hypothesis.packed(theta)[1]
        return self.with_angles([t.angles(self.gear_ratio, sensors) for t in self.traces])

    def first_starts(self) -> list[Array]:
        """Initial values read from the recordings, completed by the model where a channel is missing."""
        ratio = self.gear_ratio
        starts: list[Array] = []
        for trace in self.traces:
            motor, wheel, shaft = trace.start
            if self.resting[len(starts)]:
                motor = wheel = 0.0
            if not np.isfinite(motor):
                motor = wheel * ratio if np.isfinite(wheel) else 0.0
            if not np.isfinite(wheel):
                wheel = motor / ratio
            starts.append(np.array([motor, wheel, shaft if np.isfinite(shaft) else 0.0, 0.0, 0.0]))
        return starts

    def outputs(self, trace: int, slots: Array, sensors: Array, starts: Array) -> Array:
        """Simulated channels of one recording for many sets: sets x blocks x 3.

        Raises:
            OutOfTimeError: the search has used up its allowance.
        """
        self.allowance.check()
        return self.simulated(trace, slots, sensors, starts, self.traces[trace].block)

    def simulated(self, trace: int, slots: Array, sensors: Array, starts: Array, block: int) -> Array:
        """Like `outputs` for blocks of any length, whatever is left of the allowance."""
        t = self.traces[trace]
        angles, functions = self.angles[trace], self.functions
        return np.asarray(
            simulate_many(slots, t.torque, t.dt, starts, sensors, block, angles, t.load, functions)
        )

    def errors(self, trace: int, simulated: Array) -> Array:
        """Weighted measured minus simulated, blocks x 3, 0 where not measured or not judged."""
        weights = self.weights[trace]
        difference = np.where(weights > 0, self.traces[trace].measured - simulated, 0.0)
        error = np.nan_to_num(difference * weights, nan=HUGE, posinf=HUGE, neginf=-HUGE)
        error = np.clip(error, -HUGE, HUGE)
        error[: self.traces[trace].lead_blocks] = 0.0
        return self._counted(trace, self._whitened(error))

    def changes(self, trace: int, simulated: Array) -> Array:
        """Weighted change of the channels of one recording from the first of `simulated` to each other.

        Args:
            simulated: sets x blocks x 3.

        Returns:
            (sets - 1) x blocks x 3, 0 where errors do not count.
        """
        change = simulated[1:] - simulated[0]
        change *= self.weights[trace]
        change[:, : self.traces[trace].lead_blocks] = 0.0
        if self.whitening is not None:
            change = np.stack([self._whitened(one) for one in change])
        return self._counted(trace, change)

    def _counted(self, trace: int, values: Array) -> Array:
        """Values (... x blocks x 3), 0 where errors do not count."""
        judged = self.traces[trace].judged
        return values if judged is None else np.where(judged[:, None], values, 0.0)

    def _whitened(self, error: Array) -> Array:
        """Errors (blocks x 3) through each channel's whitening filter, if there is one."""
        if self.whitening is None:
            return error
        count = len(error)
        return np.column_stack([np.convolve(w, error[:, c])[:count] for c, w in enumerate(self.whitening)])

    def costs(self, points: list[tuple[Array, Array]], starts: list[Array]) -> Array:
        """Sum of squared errors of several points (slots, sensors); `starts`: per recording, points x 3."""
        return self.tried(points, starts).costs

    def tried(self, points: list[tuple[Array, Array]], starts: list[Array]) -> Tried:
        """Like `costs`, with what the points showed."""
        slots = np.stack([p for p, _ in points])
        sensors = np.stack([s for _, s in points])

        def errors(index: int) -> tuple[Array, Array]:
            simulated = self.outputs(index, slots, sensors, starts[index])
            return np.stack([self.errors(index, one).ravel() for one in simulated]), simulated

        rows, shown = (
            list(each) for each in zip(*map_on_threads(errors, range(len(self.traces))), strict=True)
        )
        total = np.zeros(len(points))
        for index, own in enumerate(rows):
            total += np.sum(own**2, axis=1) + (starts[index] ** 2) @ self.start_precision(index)
        return Tried(total, rows, shown)

    def normals(self, errors: Sequence[Errors], starts: Sequence[Array]) -> tuple[Normal, ...]:
        """Normal equations of each recording, its initial values held as firmly as they are known."""
        return tuple(
            self._anchored(normal_equations(one.by_coordinate, one.by_start, one.rows), index, start)
            for index, (one, start) in enumerate(zip(errors, starts, strict=True))
        )

    def cheapest_start(self, trace: int, point: tuple[Array, Array], tried: Array) -> tuple[Array, float]:
        """Of the initial values `tried` (n x STARTS) of a recording those that cost least, and that cost."""
        slots, sensors = point
        sets = len(tried)
        shown = self.outputs(trace, np.tile(slots, (sets, 1)), np.tile(sensors, (sets, 1, 1)), tried)
        costs = np.array([np.sum(self.errors(trace, one) ** 2) for one in shown])
        costs += tried**2 @ self.start_precision(trace)
        least = int(np.argmin(costs))
        return tried[least], float(costs[least])

    def linearised(
        self,
        hypothesis: Hypothesis,
        theta: Array,
        starts: list[Array],
        shown: Sequence[Array] | None = None,
    ) -> Linearised:
        """Errors and their derivatives at `theta` and `starts`, by finite differences.

        Args:
            shown: of each recording the channels (blocks x 3) that are simulated there, where known already.
        """
        coordinates = hypothesis.coordinates()
        here = hypothesis.packed(theta)
        signed = np.array(
            [c.step if v + c.step <= c.upper else -c.step for c, v in zip(coordinates, theta, strict=True)]
        )
        moved = [hypothesis.packed(theta + one) for one in np.diag(signed)]
        steps = self.start_steps()

        def derived(index: int) -> tuple[float, Errors]:
            start, free = starts[index], self.free_starts(index, hypothesis)
            points = [*([here] if shown is None else []), *moved, *[here] * len(free)]
            tried = np.tile(start, (len(points), 1))
            tried[len(points) - len(free) :] += np.diag(steps)[free]
            slots, sensors = (np.stack(each) for each in zip(*points, strict=True))
            simulated = self.outputs(index, slots, sensors, tried)
            if shown is not None:
                simulated = np.concatenate([shown[index][None], simulated])
            error = self.errors(index, simulated[0]).ravel()
            change = self.changes(index, simulated).reshape(len(simulated) - 1, -1)
            # a diverged simulation: no derivative that could be followed
            change[~(np.abs(change).max(axis=1) < DIVERGED)] = 0.0
            shared = (change[: len(moved)] / signed[:, None]).T
            initial = np.zeros((len(error), STARTS))
            initial[:, free] = (change[len(moved) :] / steps[free][:, None]).T
            cost = float(error @ error) + float(start**2 @ self.start_precision(index))
            return cost, Errors(error, shared, initial)

        costs, errors = zip(*map_on_threads(derived, range(len(starts))), strict=True)
        return Linearised(sum(costs), self.normals(errors, starts), errors)

    def free_starts(self, trace: int, hypothesis: Hypothesis) -> list[int]:
        """Which of a recording's initial values a plant has that may be others than `first_starts` says.

        A tyre that holds an axle at rest is not twisted, and the vehicle stands; but where a play begins in
        its gap is stated by a torque that twists a tyre, and does not act there.
        """
        if self.functions is None and hypothesis.kind == "rigid":
            return [MOTOR]
        moves = hypothesis.remembers_place or not self.resting[trace]
        tyre = moves and hypothesis.kind == "three_inertia"
        return [MOTOR, WHEEL, SHAFT, VEHICLE, TYRE] if tyre else [MOTOR, WHEEL, SHAFT]

    def _anchored(self, n: Normal, index: int, start: Array) -> Normal:
        precision = self.start_precision(index)
        gradient = n.start_gradient - precision * start
        return Normal(n.shared, n.between, n.start + np.diag(precision), n.shared_gradient, gradient)

    def start_precision(self, trace: int) -> Array:
        """How firmly a recording's initial values are held at zero: the speeds of one that begins at rest.

        A frictionless model cannot tell an offset of one speed channel from one of the other; an axle at
        rest can.
        """
        if not self.resting[trace]:
            return np.array([0.0, 0.0, 0.0, *(1.0 / np.array(MID_MOTION) ** 2)])
        known = np.where(np.isfinite(self.noise), self.noise, np.inf)[:2]
        firm = 1.0 / np.maximum(REST_SHARE * known, 1e-9) ** 2
        return np.array([*firm, 0.0, *(1.0 / (REST_SHARE * np.array(MID_MOTION)) ** 2)])

    def start_steps(self) -> Array:
        """Sizes of the finite differences in the initial values."""
        typical = np.array([0.1, 0.0125, 1.0])
        read = np.where(np.isfinite(self.noise) & (self.noise > 0), 0.5 * self.noise, typical)
        return np.array([*read, *(STEP * np.array(MID_MOTION))])


def problem_of(
    traces: Sequence[Trace],
    noise: Array,
    gear_ratio: float,
    *,
    floor: Array | None = None,
    stated: Mapping[str, float] | None = None,
    allowance: Allowance = UNBOUNDED,
    functions: Mapping[str, TransferFunction] | None = None,
) -> Problem:
    """Recordings weighed by `noise`, with the angles that their speeds give.

    Args:
        noise: standard deviation of each channel per sample, rounding included, shape (3,).
        floor: the same of single readings, without rounding; like `noise` if None.
        stated: standard deviation per sample that a channel's noise is known to have, from outside.
    """
    noise = read_only(noise)
    floor = noise if floor is None else read_only(floor)
    weights = [np.where(t.has, np.sqrt(t.block) / np.where(noise > 0, noise, np.inf), 0.0) for t in traces]
    resting = tuple(_rests(t, noise, floor, gear_ratio) for t in traces)
    return Problem(
        tuple(t if rests else replace(t, lead=_lead(t)) for t, rests in zip(traces, resting, strict=True)),
        noise,
        floor,
        gear_ratio,
        tuple(t.angles(gear_ratio) for t in traces),
        tuple(map(read_only, weights)),
        resting,
        read_only(proven_noise(traces, noise, stated)),
        allowance=allowance,
        functions=functions or None,
    )


def _lead(trace: Trace) -> int:
    """How many samples at the beginning may show a torque that no one recorded."""
    return min(round(LEAD_S / trace.dt), len(trace.samples) // LEAD_PART)


def read_only(values: Array) -> Array:
    """A copy that no one can write to: it is shared."""
    copy = values.copy()
    copy.setflags(write=False)
    return copy


def _rests(trace: Trace, noise: Array, floor: Array, gear_ratio: float) -> bool:
    """Whether the recording begins at rest: a speed channel reads zero, and no torque is asked for.

    A channel whose rounding is coarser than its noise reads zero at many speeds. Where the other one reads a
    speed, it may be wrong by an offset; but a noisy zero that goes with that speed as well tells nothing.
    """
    speeds, level = trace.start[:2], noise[:2]
    ratio = np.array([gear_ratio, 1.0 / gear_ratio])
    near = np.abs(speeds) < REST_SIGMAS * level / np.sqrt(REST_SAMPLES)
    tells = trace.has[:2] & (level < FINE * floor[:2])
    unsure = REST_SIGMAS * level / np.sqrt(trace.start_samples)
    moves = np.abs(speeds) > unsure
    apart = np.abs(speeds - ratio * speeds[::-1]) > np.hypot(unsure, ratio * unsure[::-1])
    still = near & tells & (apart | ~moves[::-1])
    idle = abs(trace.torque[0]) <= LITTLE_TORQUE * float(np.max(np.abs(trace.torque)))
    return bool(np.any(still) and idle)
