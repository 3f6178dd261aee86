"""Where to look first: probes of every effect, sized by the scene of the recordings, and wrong parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from hil.analysis.diagnosis.fit.coordinates import Hypothesis, key_of
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.thresholds import STEP
from hil.analysis.diagnosis.search.orders import order_lines
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, Direction, Probe
from hil.core.model import EffectUse, parameter_names
from hil.plant import chain_numbers


@dataclass(frozen=True)
class Recorded:
    """The `Scene` of a problem and of what a fit leaves of it."""

    problem: Problem
    fit: Fit

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Of the model with what was found so far, corrected: a third inertia that was added has its tyre."""
        return chain_numbers(self.fit.hypothesis.model(self.fit.theta))._asdict()

    @property
    def torque_nm(self) -> float:
        """Largest requested torque."""
        return max(float(np.max(np.abs(t.torque))) for t in self.problem.traces)

    @property
    def shaft_torque_nm(self) -> float:
        """Largest shaft torque, by the model where it was not measured."""
        found = 0.0
        for t in self.problem.traces:
            high = np.nanmax(np.abs(t.measured[:, 2])) if np.isfinite(t.measured[0, 2]) else 0.0
            found = max(found, float(high))
        return found or 0.7 * self.torque_nm * self.parameters["gear_ratio"]

    @property
    def channels(self) -> tuple[str, ...]:
        """Those that any recording has."""
        has = np.any([t.has for t in self.problem.traces], axis=0)
        return tuple(channel for channel, measured in zip(OUTPUTS, has, strict=True) if measured)

    def orders(self, side: Literal["wheel", "rotor"]) -> list[float]:
        """Orders of turning that stand out in the errors, strongest first."""
        shaft: Literal["wheel", "motor"] = "motor" if side == "rotor" else "wheel"
        return [line.order for line in order_lines(self.problem, self.fit, shaft)]


@dataclass(frozen=True)
class Candidate:
    """A probe of an effect; values that it leaves out are the effect's defaults."""

    id: str
    probe: Probe

    @property
    def key(self) -> tuple[str, str]:
        """Id and channel."""
        return key_of(self.along(self.directions[0]))

    @property
    def directions(self) -> tuple[Direction, ...]:
        """Of the probe."""
        return self.probe.directions

    def along(self, direction: Direction) -> EffectUse:
        """The effect as a direction has it."""
        return self._use(direction.values)

    def use(self, amounts: Sequence[float]) -> EffectUse:
        """The effect with the values that `amounts` of the directions stand for."""
        return self._use(self.probe.start(amounts))

    def _use(self, values: dict[str, float | str]) -> EffectUse:
        return EffectUse(self.id, EFFECTS[self.id].completed(values))


def probes(problem: Problem, fit: Fit) -> list[Candidate]:
    """Probes of every effect that can still be added to the hypothesis of `fit`."""
    scene = Recorded(problem, fit)
    taken = set(fit.hypothesis.keys) | {key_of(use) for use in fit.hypothesis.base.effects}
    found = []
    for effect in EFFECTS.values():
        if effect.probes is None or fit.hypothesis.kind not in effect.needs or (effect.id, "") in taken:
            continue
        if effect.id == "dead_time" and delay_is_free(fit):
            continue
        for probe in effect.probes(scene):
            candidate = Candidate(effect.id, probe)
            if candidate.key not in taken:
                found.append(candidate)
    return found


def delay_is_free(fit: Fit) -> bool:
    """Whether the model's own dead time may still grow: then none is missing beside it."""
    if not fit.hypothesis.far:
        return False
    own = [
        (c, v)
        for c, v in zip(fit.hypothesis.coordinates(), fit.theta, strict=True)
        if c.name == "torque_delay"
    ]
    return any(value < c.upper - STEP for c, value in own)


def mismatches(hypothesis: Hypothesis) -> list[EffectUse]:
    """One candidate for each parameter of the base model that may be wrong; none where all are free."""
    if hypothesis.far:
        return []
    taken = set(hypothesis.keys)
    return [
        EffectUse("parameter_mismatch", {"parameter": name, "value": hypothesis.base.parameters[name]})
        for name in parameter_names(hypothesis.base.kind)
        if hypothesis.base.parameters[name] > 0.0
        and ("parameter_mismatch", name) not in taken
        and name not in ("torque_delay", *hypothesis.held)
    ]
