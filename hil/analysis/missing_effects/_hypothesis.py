"""A hypothesis: the base model's numbers, all free, and a set of effects, as coordinates of one fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.core.chain import Chain
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, Parameter
from hil.core.model import EffectUse, Model, kind_of, parameter_of_effect
from hil.plant import chain_numbers, pack, sensor_of

Array = npt.NDArray[np.float64]
Laws = tuple[float | str, ...]

TOLERANCE = 0.02
"""A number of a base is right to that share, where the model file states none, or it may be anything."""
_TEETH = 1e-3  # tolerance of a gear ratio: teeth are counted
_LONGEST_DELAY_S = 0.5


def tolerance_of(model: Model, name: str) -> float:
    """Share to which a base's number is right, if it is: by the model file, or what is usual."""
    usual = _TEETH if name == "gear_ratio" else TOLERANCE
    return float(model.tolerance.get(name, usual))


@dataclass(frozen=True)
class Coordinate:
    """One free number; a fit moves u from 0: value·e^u where `logarithmic`, else value + scale·u.

    `term` is the effect's place in the hypothesis, -1 for a number of the base; `base` is what the base says
    of it, right to a share `tolerance`, for the prior (None: no prior).
    """

    term: int
    name: str
    value: float
    scale: float
    logarithmic: bool
    lower: float
    upper: float
    base: float | None = None
    step: float = 1e-3
    tolerance: float = TOLERANCE

    @property
    def is_idle(self) -> bool:
        """Whether a number of an effect is zero and cannot be less: as if the effect had none."""
        return self.term >= 0 and self.value == self.lower == 0.0

    def at(self, u: float) -> float:
        """The number at a coordinate."""
        return self.value * math.exp(u) if self.logarithmic else self.value + self.scale * u

    def of(self, value: float) -> float:
        """The coordinate of a number."""
        if self.logarithmic:
            return math.log(max(value, 1e-300) / self.value)
        return (value - self.value) / self.scale

    def away(self, u: float) -> float:
        """How far the number is from what the base says, in tolerances; 0 where that says nothing."""
        if not self.base:
            return 0.0
        share = math.log(self.at(u) / self.base) if self.logarithmic else self.at(u) / self.base - 1.0
        return share / self.tolerance

    def away_slope(self) -> float:
        """Change of `away` with the coordinate."""
        if not self.base:
            return 0.0
        return (1.0 if self.logarithmic else self.scale / self.base) / self.tolerance

    def slope(self, u: float) -> float:
        """Change of the number with the coordinate."""
        return self.value * math.exp(u) if self.logarithmic else self.scale


@dataclass(frozen=True)
class Hypothesis:
    """`base` as it came; `numbers` as they are now; effects, and which of their optional numbers move."""

    base: Model
    numbers: Mapping[str, float]
    terms: tuple[EffectUse, ...] = ()
    opened: tuple[frozenset[str], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, each with the channel that it is about."""
        return tuple(label_of(use) for use in self.terms)

    @classmethod
    def alone(cls, base: Model) -> Hypothesis:
        """A base as it came: all its numbers, those of the effects that it carries included."""
        carried = {name: float(use.values[one.name]) for name, (use, one) in _numbers_carried(base).items()}
        return cls(base, {**base.parameters, **carried})

    @property
    def laws(self) -> tuple[Laws, ...]:
        """Which of the laws that they may have its effects have."""
        return tuple(laws_of(use) for use in self.terms)

    def with_number(self, name: str, value: float) -> Hypothesis:
        """The same, one number of the base another one."""
        return replace(self, numbers={**self.numbers, name: value})

    def with_term(self, use: EffectUse, opened: frozenset[str] = frozenset()) -> Hypothesis:
        """The same with one more effect."""
        complete = EffectUse(use.id, EFFECTS[use.id].completed(use.values))
        return replace(self, terms=(*self.terms, complete), opened=(*self.opened, opened))

    def without(self, index: int) -> Hypothesis:
        """The same without one of its effects."""
        keep = [i for i in range(len(self.terms)) if i != index]
        return replace(
            self, terms=tuple(self.terms[i] for i in keep), opened=tuple(self.opened[i] for i in keep)
        )

    def with_values(self, index: int, values: Mapping[str, float], opened: frozenset[str]) -> Hypothesis:
        """The same, some numbers of an effect other ones, and which of its optional numbers move."""
        terms, free, use = list(self.terms), list(self.opened), self.terms[index]
        terms[index], free[index] = EffectUse(use.id, {**use.values, **values}), opened
        return replace(self, terms=tuple(terms), opened=tuple(free))

    def closed(self, index: int, optional: str) -> Hypothesis:
        """The same, an optional number of an effect where it does nothing."""
        parameters = EFFECTS[self.terms[index].id].parameters
        default = next(one.default for one in parameters if one.name == optional)
        return self.with_values(index, {optional: default}, self.opened[index] - {optional})

    @property
    def is_abrupt(self) -> bool:
        """Whether an effect makes the misfit jump with every number, as the contact of a play does."""
        return any(EFFECTS[use.id].abrupt for use in (*self.base.effects, *self.terms))

    @property
    def kind(self) -> str:
        """Kind of the model, its effects included."""
        return kind_of(self.base.kind, self.terms)

    def model(self) -> Model:
        """The model that it is, to simulate or to write."""
        parameters = {name: self.numbers[name] for name in self.base.parameters}
        effects = (*map(self._as_now, self.base.effects), *self.terms)
        return replace(self.base, parameters=parameters, effects=effects, meta={})

    def _as_now(self, use: EffectUse) -> EffectUse:
        """An effect of the base with its numbers as they are now."""
        names = {one: parameter_of_effect(use, one) for one in use.values}
        now = {one: self.numbers[name] for one, name in names.items() if name in self.numbers}
        return EffectUse(use.id, {**use.values, **now})

    def chain(self) -> Chain:
        """Linear numbers of the model that it is."""
        return chain_numbers(self.model())

    def coordinates(self, scales: Mapping[str, float]) -> list[Coordinate]:
        """All free numbers; `scales` gives the size of numbers of the base that may be zero."""
        found = [self._number(name, scales) for name in self.numbers]
        for index, use in enumerate(self.terms):
            for parameter in EFFECTS[use.id].parameters:
                if parameter.fitted and (not parameter.optional or parameter.name in self.opened[index]):
                    found.append(_of_effect(index, use, parameter))
        return found

    def _number(self, name: str, scales: Mapping[str, float]) -> Coordinate:
        value = float(self.numbers[name])
        if name not in self.base.parameters:
            use, parameter = _numbers_carried(self.base)[name]
            one = _of_effect(-1, EffectUse(use.id, {**use.values, parameter.name: value}), parameter)
            return replace(one, name=name, base=float(use.values[parameter.name]))
        base = float(self.base.parameters[name])
        if name in scales:  # may be zero
            if name != "torque_delay":
                return Coordinate(-1, name, value, scales[name], False, 0.0, math.inf)
            # a rigid axle's shaft torque steps from sample to sample: its slope is seen over a whole one
            step = 1.0 if self.base.kind == "rigid" else 1e-3
            return Coordinate(
                -1, name, value, scales[name], False, 0.0, _LONGEST_DELAY_S, base or None, step,
                tolerance_of(self.base, name),
            )  # fmt: skip
        tolerance = tolerance_of(self.base, name)
        return Coordinate(-1, name, value, 1.0, True, value * 1e-3, value * 1e3, base, tolerance=tolerance)

    def moved(self, coordinates: Sequence[Coordinate], u: Array) -> Hypothesis:
        """The hypothesis at a point of its coordinates."""
        numbers = dict(self.numbers)
        values = [dict(use.values) for use in self.terms]
        for one, at in zip(coordinates, u.tolist(), strict=True):
            (numbers if one.term < 0 else values[one.term])[one.name] = min(
                max(one.at(at), one.lower), one.upper
            )
        terms = tuple(EffectUse(use.id, v) for use, v in zip(self.terms, values, strict=True))
        return replace(self, numbers=numbers, terms=terms)

    def packed(self) -> tuple[Array, Array]:
        """(slots, sensors 3 x numbers) for the kernels."""
        model = self.model()
        return pack(model), np.stack([sensor_of(model, channel) for channel in OUTPUTS])


def _numbers_carried(base: Model) -> dict[str, tuple[EffectUse, Parameter]]:
    """Numbers of the effects of a base that a fit may move, by name: `coulomb_friction.torque_nm`.

    Of what follows an angle only the size: order and phase are those of the angles that it was found with.
    """
    found = {}
    for use in base.effects:
        effect = EFFECTS[use.id]
        for one in effect.parameters:
            acts = one.name in effect.acting() or not effect.law.follows
            if one.fitted and acts and use.values.get(one.name, one.default) != one.default:
                found[parameter_of_effect(use, one.name)] = use, one
    return found


def label_of(use: EffectUse) -> str:
    """An effect's name, with the channel or parameter that it is about."""
    return EFFECTS[use.id].label(use.values)


def laws_of(use: EffectUse) -> Laws:
    """Numbers of an effect between which a diagnosis chooses."""
    return tuple(use.values.get(one.name, one.default) for one in EFFECTS[use.id].parameters if one.choices)


def is_linear(use: EffectUse) -> bool:
    """Whether an effect changes the linear chain or what a sensor reads, or is a gain: no law bends."""
    law = EFFECTS[use.id].law
    if 0.0 < EFFECTS[use.id].off < math.inf:
        return True
    return (law.chain is not None or law.reads is not None) and law.tyre_rate is None


def is_loss(use: EffectUse) -> bool:
    """Whether an effect brakes whatever turns: a friction, a drag, a resistance."""
    law = EFFECTS[use.id].law
    return law.follows is None and any(one is not None for one in (law.dry, law.loss, law.load))


def bends(use: EffectUse) -> bool:
    """Whether a law may send motion of shafts astray: neither linear, nor a loss, nor a ripple."""
    return not (is_linear(use) or is_loss(use) or EFFECTS[use.id].law.follows)


def _of_effect(index: int, use: EffectUse, parameter: Parameter) -> Coordinate:
    """A number of an effect; a gain is calibrated as numbers of a base are, or it may be anything."""
    effect, value = EFFECTS[use.id], float(use.values[parameter.name])
    is_gain = parameter.name in effect.acting() and 0.0 < effect.off < math.inf
    base = effect.off if is_gain else None
    lower, upper = parameter.within or (parameter.lower, parameter.upper)
    step = 1e-3 * parameter.step
    if parameter.typical is None and value > 0.0:
        return Coordinate(index, parameter.name, value, 1.0, True, max(lower, 1e-9), upper, base, step)
    scale = max(abs(value), parameter.typical or 1e-3)
    return Coordinate(index, parameter.name, value, scale, False, lower, upper, base, step)
