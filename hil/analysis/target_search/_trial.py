"""One guess at what an axle is, executed on the predicted bench, and what comes of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from hil.analysis.target_search._plausible import CONTROLLER, Candidate
from hil.analysis.target_search._targets import Targets
from hil.core.channels import OUTPUTS
from hil.core.errors import HilError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from hil.plant import linear_system
from test_plans import Plan, judge

SETTLED_UNTIL_S = 4.0
SETTLED_SHARE = 0.05
_SHAFT_TORQUE = "shaft_torque_nm"
BAND_HZ = (0.05, 30.0)
_FREQUENCIES = 200
_NO_FIGURES = 1e4  # cost of a guess that gives none, and the most of any: five times a figure
_MISSED = 10.0  # slope of the cost of a condition that is missed, five times that of one that just holds
_NEAR = 0.02  # of a limit: a guess that comes nearer is no safe one


class Predicted(Protocol):
    """What a run would record."""

    @property
    def recording(self) -> Recording:
        """Channels of the run."""

    @property
    def segments(self) -> tuple[Segment, ...]:
        """Its segments."""


#: Carries a plan out on a predicted bench with a model and with parameters that its RMCU keeps.
CarryOut = Callable[[Plan, Model, Mapping[str, float]], Predicted]


@dataclass(frozen=True)
class Guess:
    """Effects beside, or in place of, the base model's, with their values; parameters that the RMCU keeps."""

    effects: Mapping[str, Mapping[str, float]]
    held: Mapping[str, float]

    def model(self, base: Model) -> Model:
        """The base model with the guess's effects; an effect that it has already takes the guess's values."""
        kept = [use for use in base.effects if use.id not in self.effects]
        own = [EffectUse(id_, dict(values)) for id_, values in self.effects.items()]
        return base.with_effects(*kept, *own)


def guess_at(point: np.ndarray, chosen: tuple[Candidate, ...]) -> Guess:
    """The guess at a point of the unit cube that the numbers of `chosen` span."""
    effects: dict[str, dict[str, float]] = {}
    held: dict[str, float] = {}
    shares = iter(np.clip(point, 0.0, 1.0))
    for candidate in chosen:
        values = {number.name: number.at(float(next(shares))) for number in candidate.numbers}
        if candidate.id == CONTROLLER:
            held |= values
        else:
            effects[candidate.id] = values
    return Guess(effects, held)


@dataclass(frozen=True)
class Outcome:
    """What a guess gives; figures in the criteria's units, None where a response has none.

    Args:
        figures: of the targets, over the whole segment; early: the same, in the first seconds only.
        ratios: of each criterion that compares two segments: value over the value that it must be below.
        unsettled: by segment, largest deviation of T_s from its mean over the step's size.
        misfit: by output, rms over frequency of the linear response against the target's, dB and degrees.
        prediction: None where the guess could not be executed.
    """

    figures: Mapping[str, float | None]
    early: Mapping[str, float | None]
    ratios: Mapping[str, float | None]
    unsettled: Mapping[str, float]
    misfit: Mapping[str, tuple[float, float]]
    prediction: Predicted | None = None

    def cost(self, targets: Targets) -> float:
        """Sum of what is wrong, each over what is allowed: a condition that just holds adds 1.

        Figures are to be met, by their logarithm. What only must not be exceeded costs nothing until it comes
        near its limit. A condition that is missed costs far more than how well others hold.
        """
        total = 0.0
        allowed = math.log1p(targets.tolerance)
        for name, wanted in targets.values.items():
            for figure in (self.figures[name], *([self.early[name]] if targets.first_seconds else [])):
                if figure is None or figure <= 0.0:
                    return _NO_FIGURES
                total += _cost(abs(math.log(figure / wanted)) / allowed)
        limited = [ratio for ratio in self.ratios.values() if ratio is not None]
        limited += [deviation / SETTLED_SHARE for deviation in self.unsettled.values()]
        if targets.response:
            for name, found in self.misfit.items():
                limited += [
                    value / most for value, most in zip(found, targets.response.within[name], strict=True)
                ]
        total += sum(_cost(max(0.0, share - 1.0 + _NEAR) / _NEAR) for share in limited)
        return min(total, _NO_FIGURES)


def _cost(share: float) -> float:
    """What a share of what is allowed costs: its square, steeply more than 1 beyond."""
    return share**2 if share < 1.0 else 1.0 + _MISSED * (share - 1.0)


class Trial:
    """Carries guesses out; of the plan's criteria, only those that are asked for are judged."""

    def __init__(self, base: Model, execute: CarryOut, targets: Targets) -> None:
        self.base, self.targets, self._execute = base, targets, execute
        wanted = [c for c in targets.plan.criteria if c.id in targets.values or c.below]
        self.plan = targets.plan.model_copy(update={"criteria": tuple(wanted)})

    def of(self, guess: Guess) -> Outcome:
        """What comes of a guess in the whole plan."""
        model = guess.model(self.base)
        try:
            found = self.run(self.plan, guess)
        except HilError:  # the bench refuses it, or it does not reach a speed: no figure
            nothing = dict.fromkeys(self.targets.values)
            return Outcome(nothing, nothing, {}, {}, {})
        return self._outcome(found, model)

    def run(self, plan: Plan, guess: Guess) -> Predicted:
        """A plan executed on a guess.

        Raises:
            HilError: the run would fail.
        """
        return self._execute(plan, guess.model(self.base), guess.held)

    def _outcome(self, found: Predicted, model: Model) -> Outcome:
        criteria = judge(self.plan, found.recording, found.segments, measured=False, device=False)
        early = criteria
        if self.targets.first_seconds is not None:
            segments = [_cut(segment, self.targets.first_seconds) for segment in found.segments]
            only = self.plan.model_copy(
                update={"criteria": tuple(c for c in self.plan.criteria if c.id in self.targets.values)}
            )
            early = judge(only, found.recording, segments, measured=False, device=False)
        return Outcome(
            _figures(criteria, self.targets),
            _figures(early, self.targets),
            {c.id: _ratio(c) for c in criteria if c.below},
            {s.id: self._unsettled(found, s) for s in found.segments if s.id in self.targets.settles},
            self.misfit(model),
            found,
        )

    def _unsettled(self, found: Predicted, segment: Segment) -> float:
        after = segment.step_s + self.targets.settles[segment.id]
        until = min(segment.end_s, segment.step_s + SETTLED_UNTIL_S)
        values = found.recording.between(after, until)[_SHAFT_TORQUE]
        size = abs(segment.reference_after - segment.reference_before)
        return float(np.max(np.abs(values - np.mean(values))) / size)

    def misfit(self, model: Model) -> dict[str, tuple[float, float]]:
        """Of the model's linear part, which is what an effect without memory or force changes in a chirp."""
        wanted = self.targets.response
        if wanted is None:
            return {}
        frequency = np.geomspace(*BAND_HZ, _FREQUENCIES)
        response = linear_system(model).response(frequency)
        return {
            name: rms_misfit(response[OUTPUTS.index(name)], wanted.functions, name, frequency)
            for name in wanted.within
        }


def rms_misfit(response: Any, functions: Model, name: str, frequency_hz: Any) -> tuple[float, float]:
    """Rms over frequency of a response against a function, in dB and in degrees."""
    ratio = np.asarray(response) / functions.transfer_functions[name].response(frequency_hz)
    gain_db = 20.0 * np.log10(np.abs(ratio))
    phase_deg = np.degrees(np.unwrap(np.angle(ratio)))
    return float(np.sqrt(np.mean(gain_db**2))), float(np.sqrt(np.mean(phase_deg**2)))


def _cut(segment: Segment, seconds: float) -> Segment:
    return segment.model_copy(update={"end_s": min(segment.end_s, segment.step_s + seconds)})


def _figures(criteria: tuple[CriterionResult, ...], targets: Targets) -> dict[str, float | None]:
    values = {c.id: c.value for c in criteria}
    return {name: values.get(name) for name in targets.values}


def _ratio(criterion: CriterionResult) -> float | None:
    if criterion.value is None or not criterion.upper:
        return None
    return criterion.value / criterion.upper
