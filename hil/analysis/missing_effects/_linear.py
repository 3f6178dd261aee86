"""Linear structure by frequency responses: numbers and linear effects of a chain, from any base of its kind.

In windows of a recording the transform of an output is G(f)·U(f) and an error, by the same likelihood as
the errors in time. Only the cross and power spectra of torque and outputs are needed, so that a hypothesis
costs one response in place of simulations, and resonances that are far off are found from many starts. A lag,
a mount or a tyre behind a far base shows here; what is nonlinear bends responses and is left to the fit in
time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import ENOUGH, ROUNDS, bounds_of, least_squares
from hil.analysis.missing_effects._hypothesis import Coordinate, Hypothesis
from hil.analysis.missing_effects._odds import ALIKE
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import Scene, may_join, probes_of
from hil.analysis.missing_effects._series import Series
from hil.analysis.missing_effects._spectrum import Powers, bands_of, edges_hz, transformed
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.core.runtime.thread_map import map_on_threads
from hil.plant import SENSOR_TURNED, linear_system_of, sensor_response

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_DRAWS = 200  # starts whose responses are looked at
_STARTS = 2  # of these are fitted
_SPREAD = np.log(3.0)  # of a start's numbers, as of their prior
_EVALUATIONS = 20
_STEP = 1e-5  # of a coordinate, for derivatives
_FAR = 3.0  # logarithm of a response's misfit, beyond which all are alike


@dataclass(frozen=True)
class Responses:
    """Measured responses of the outputs to the torque, bins x 3, and what no linear system explains.

    `input_power` (bins,) and `rest` (bins x 3) are means of so many `windows`, of a block mean;
    `turned_over_s` (3,) is that of a series.
    """

    problem: Problem
    frequency_hz: Array
    input_power: Array
    found: ComplexArray
    rest: Array
    windows: int
    turned_over_s: Array

    def response(self, hypothesis: Hypothesis) -> ComplexArray:
        """Of a hypothesis' linear part, sensors included: bins x 3."""
        slots, sensors = hypothesis.packed()
        sensors[:, SENSOR_TURNED] = self.turned_over_s
        plant = linear_system_of(slots).response(self.frequency_hz)
        return np.asarray((plant * sensor_response(sensors, self.frequency_hz)).T)

    def powers(self, hypothesis: Hypothesis) -> Powers:
        """Of the errors that a hypothesis leaves."""
        return self._powers(self.response(hypothesis))

    def _powers(self, response: ComplexArray) -> Powers:
        edges = edges_hz(self.problem.rate_hz)
        band = bands_of(edges, self.frequency_hz)
        error = np.abs(response - self.found) ** 2 * self.input_power[:, None] + self.rest
        there = np.isfinite(error)
        count = np.stack([np.bincount(band, one, len(edges) - 1) for one in there.T.astype(float)])
        sums = np.stack([np.bincount(band, one, len(edges) - 1) for one in np.nan_to_num(error).T])
        power = np.repeat((sums / np.maximum(count, 1.0))[None], self.windows, axis=0)
        bins, problem = np.repeat(0.5 * count[None], self.windows, axis=0), self.problem
        return Powers(edges, power, bins, problem.signal, colour=problem.colour)

    def log_likelihood(self, hypothesis: Hypothesis) -> float:
        """Of the responses."""
        return float(np.sum(self.powers(hypothesis).log_likelihood(self.problem.noise)))

    def most(self) -> float:
        """Log likelihood of a model whose responses are those measured."""
        return float(np.sum(self._powers(self.found).log_likelihood(self.problem.noise)))

    def misfit(self, hypothesis: Hypothesis) -> float:
        """Mean square of the logarithm of modelled over measured response, where that is coherent."""
        seen = np.abs(self.found) ** 2 * self.input_power[:, None]
        weight = np.nan_to_num(seen / (seen + self.rest))
        with np.errstate(all="ignore"):
            away = np.abs(np.log(self.response(hypothesis) / self.found))
        return float(np.sum(weight * np.minimum(np.nan_to_num(away, nan=_FAR), _FAR) ** 2) / np.sum(weight))

    def fitted(self, hypothesis: Hypothesis, rounds: int = ROUNDS) -> Hypothesis:
        """Numbers that suit responses and prior best, from those of a hypothesis.

        Where most numbers of a base are off, each alone is held where the base has it: so the way is gone
        without the prior as well (but for a gear ratio: teeth were counted), and from its end with it.
        """
        held = self._descended(hypothesis, rounds)
        if self.problem.log_prior(held) > -ALIKE:  # calibrated: nothing holds them
            return held
        freed = self._descended(self._descended(hypothesis, rounds, prior=False), rounds)
        return max((held, freed), key=self.posterior)

    def posterior(self, hypothesis: Hypothesis) -> float:
        """Log likelihood of the responses and log density of the base's numbers."""
        return self.log_likelihood(hypothesis) + self.problem.log_prior(hypothesis)

    def _descended(self, hypothesis: Hypothesis, rounds: int, *, prior: bool = True) -> Hypothesis:
        best, reached = hypothesis, self.log_likelihood(hypothesis)
        for _ in range(rounds):
            descent = _Descent(self, hypothesis, prior=prior)
            hypothesis = hypothesis.moved(
                descent.coordinates,
                least_squares(descent, *bounds_of(descent.coordinates), _EVALUATIONS, settled=ENOUGH),
            )
            there = self.log_likelihood(hypothesis)
            if there <= reached + 0.1:
                break
            best, reached = hypothesis, there
        return best


class _Descent:
    """Residual and derivatives of a round, weighed by what the hypothesis leaves at its beginning."""

    def __init__(self, responses: Responses, hypothesis: Hypothesis, *, prior: bool) -> None:
        self.responses, self.hypothesis = responses, hypothesis
        self.coordinates: Sequence[Coordinate] = responses.problem.coordinates(hypothesis)
        self.prior = np.array([prior or one.name == "gear_ratio" for one in self.coordinates])
        spectrum = responses.powers(hypothesis).spectrum(responses.problem.noise)
        band = bands_of(spectrum.edges_hz, responses.frequency_hz)
        power = responses.windows * responses.input_power[:, None] / spectrum.variance.T[band]
        self.weight = np.sqrt(np.where(np.isfinite(responses.rest), power, 0.0))

    def residual(self, u: Array) -> Array:
        """Weighed misfit of the responses, then the prior's."""
        hypothesis = self.hypothesis.moved(self.coordinates, u)
        error = self.weight * np.nan_to_num(self.responses.response(hypothesis) - self.responses.found)
        prior = self.prior * self.responses.problem.prior(self.coordinates, u)
        return np.concatenate([error.ravel().view(float), prior])

    def jacobian(self, u: Array, wider: float = 1.0) -> Array:
        """Of the residual, by finite differences."""
        at, step = self.residual(u), wider * _STEP
        steps = [
            step if one.at(v + step) <= one.upper else -step
            for one, v in zip(self.coordinates, u, strict=True)
        ]
        return np.column_stack(
            [(self.residual(u + h * e) - at) / h for h, e in zip(steps, np.eye(len(u)), strict=True)]
        )


def responses_of(problem: Problem) -> Responses | None:
    """Responses of recordings without a brake on their wheels; None where there are none, or no shafts."""
    free = [one for one in problem.series if one.load is None]
    if problem.model.kind not in ("two_inertia", "three_inertia") or not free:
        return None
    longest = max(free, key=lambda one: len(one.torque))
    found = list(zip(free, map_on_threads(_spectra, free), strict=True))
    bins = max(len(part[1]) for _, part in found)
    alike, parts = zip(*((one, part) for one, part in found if len(part[1]) == bins), strict=True)
    windows = sum(count for count, *_ in parts)
    power = np.sum([part[1] for part in parts], axis=0) / windows
    cross = np.sum([part[2] for part in parts], axis=0) / windows
    outputs = np.sum([part[3] for part in parts], axis=0) / windows
    rate = longest.rate_hz
    frequency: Array = np.arange(len(power)).astype(np.float64) * (0.5 * rate / (len(power) - 1))
    lowest = max(edges_hz(rate)[1], min(one.lowest_hz for one in alike))
    used = (frequency >= lowest) & (frequency <= 0.5 * rate) & (power > 1e-9 * np.max(power))
    # torque is held over a sample: on its way to the plant it is late by half of one
    held = np.sinc(frequency * longest.dt) * np.exp(-1j * np.pi * frequency * longest.dt)
    power = power * np.abs(held) ** 2
    response = cross * np.conj(held)[:, None] / np.maximum(power, 1e-300)[:, None]
    rest = np.maximum(outputs - np.abs(response) ** 2 * power[:, None], 0.0)
    over_s = longest.turned_over_s
    return Responses(problem, frequency[used], power[used], response[used], rest[used], windows, over_s)


def _spectra(one: Series) -> tuple[int, Array, ComplexArray, Array]:
    """Windows of a recording, their summed power of the torque, cross and power spectra, of block means."""
    rate = 1.0 / one.dt
    whole = np.column_stack([one.torque, one.samples])[None]
    shown = transformed(whole, rate)[0] / np.sqrt(one.block)
    shown = shown[..., : 1 + (shown.shape[2] - 1) // one.block]
    torque, outputs = shown[0], shown[1:]
    return (
        len(torque),
        np.sum(np.abs(torque) ** 2, axis=0),
        np.sum(outputs * np.conj(torque), axis=1).T,
        np.sum(np.abs(outputs) ** 2, axis=1).T,
    )


def numbers_alone(responses: Responses) -> Hypothesis:
    """The base's numbers as the responses have them, without any effect."""
    base = responses.problem.as_it_came
    near = responses.fitted(base)
    return max((near, _best(responses, _scattered(responses, [base]))), key=responses.posterior)


def with_linear_effects(responses: Responses, alone: Hypothesis) -> list[tuple[Hypothesis, float]]:
    """Numbers alone with each linear effect that the responses pay for, best first, with the gain.

    None where numbers alone leave nothing to explain.
    """
    problem = responses.problem
    base = problem.as_it_came
    if responses.most() - responses.log_likelihood(alone) < ALIKE:
        return []
    found: list[tuple[Hypothesis, float]] = []
    for effect in EFFECTS.values():
        if effect.law.chain is None or not may_join(effect, alone):
            continue
        starts = [
            numbers.with_term(EffectUse(effect.id, dict(one.values)))
            for numbers in (alone, base)
            for probe in probes_of(effect, Scene(problem, numbers))
            for one in probe.directions
        ]
        best = _best(responses, _scattered(responses, starts))
        cost = 0.5 * np.log(responses.powers(best).values(problem.noise)) * (len(best.terms[0].values) + 1)
        gain = responses.posterior(best) - responses.posterior(alone) - cost
        if gain > 0.0:
            found.append((best, gain))
    return sorted(found, key=lambda pair: -pair[1])


def _best(responses: Responses, starts: Sequence[Hypothesis]) -> Hypothesis:
    """The likeliest of the few starts whose responses are nearest."""
    nearest = sorted(starts, key=responses.misfit)[:_STARTS]
    return max(map_on_threads(responses.fitted, nearest), key=responses.posterior)


def _scattered(responses: Responses, starts: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Many starts, their numbers drawn from around those given."""
    rng = np.random.default_rng(0)
    found = list(starts)
    for draw in range(_DRAWS):
        start = starts[draw % len(starts)]
        free = [
            one
            for one in responses.problem.coordinates(start)
            if one.logarithmic and one.name != "gear_ratio" and one.name in start.base.parameters
        ]
        found.append(start.moved(free, rng.normal(0.0, _SPREAD, len(free))))
    return found
