"""The numbers that a hypothesis leaves free, and where each enters the plant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.thresholds import (
    FAR_PRIOR,
    LOSS_REACH,
    MISMATCH_REACH,
    PRIOR,
    RATIO_PRIOR,
    REACH,
    STEP,
    TOLERANCE,
)
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model, kind_of, parameter_names
from hil.plant import SENSOR_STEP, pack, sensor_of

Array = npt.NDArray[np.float64]

_LOSSES = ("_damping", "_drag")


@dataclass(frozen=True)
class Coordinate:
    """One free number: of the base model (`term` -1) or of the hypothesis' effect number `term`."""

    name: str
    term: int
    scale: Literal["log", "linear"]
    lower: float
    upper: float
    step: float
    prior: float  # standard deviation of a Gaussian around zero; infinite: none


@dataclass(frozen=True)
class Hypothesis:
    """A base model with effects added; `open` names optional effect parameters that are fitted too.

    Where `far`, the base model's numbers are not trusted: all of them may go far, but for those that are
    `held`, which the recordings cannot tell. Near, their tolerance holds those.
    """

    base: Model
    terms: tuple[EffectUse, ...] = ()
    open: tuple[str, ...] = ()
    far: bool = False
    held: tuple[str, ...] = ()

    @property
    def ids(self) -> tuple[str, ...]:
        """Effect ids in order."""
        return tuple(term.id for term in self.terms)

    @property
    def kind(self) -> str:
        """Of the plant: an effect may add an inertia to the base model's."""
        return kind_of(self.base.kind, [*self.base.effects, *self.terms])

    @property
    def remembers_place(self) -> bool:
        """Whether an effect remembers a place, as a play does: its motion may be chaotic."""
        return any(EFFECTS[id_].law.begin is not None for id_ in self.ids)

    @property
    def of_many_laws(self) -> bool:
        """Whether formulas differ for any of its effects."""
        return any(EFFECTS[id_].many_laws for id_ in self.ids)

    @property
    def keys(self) -> tuple[tuple[str, str], ...]:
        """Effect ids with the channel or parameter they speak of."""
        return tuple(key_of(term) for term in self.terms)

    def with_term(self, term: EffectUse) -> Hypothesis:
        """One effect more."""
        return replace(self, terms=(*self.terms, term))

    def without(self, index: int) -> Hypothesis:
        """One effect less."""
        return replace(self, terms=self.terms[:index] + self.terms[index + 1 :])

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Free numbers: base parameters first, then those of the effects."""
        wrong = {str(t.values["parameter"]) for t in self.terms if t.id == "parameter_mismatch"}
        found = []
        for name in parameter_names(self.base.kind):
            value = self.base.parameters[name]
            if (
                value == 0.0
                or (self.far and name in self.held)
                or (name == "torque_delay" and "dead_time" in self.ids)
            ):
                continue
            reach, prior = self.freedom(name)
            if name in wrong:
                reach, prior = MISMATCH_REACH, np.inf
            found.append(Coordinate(name, -1, "log", -reach, reach, STEP, prior))
        for index, term in enumerate(self.terms):
            found += self._of_term(index, term)
        return tuple(found)

    def freedom(self, name: str) -> tuple[float, float]:
        """How far a parameter may go, and the standard deviation of its correction, natural logarithms."""
        if self.far:
            prior = RATIO_PRIOR if name == "gear_ratio" else FAR_PRIOR
            return LOSS_REACH if name.endswith(_LOSSES) else MISMATCH_REACH, prior
        widened = self.base.tolerance.get(name, TOLERANCE) / TOLERANCE
        return REACH * widened, PRIOR * widened

    def _of_term(self, index: int, term: EffectUse) -> list[Coordinate]:
        found = []
        for parameter in EFFECTS[term.id].parameters:
            if not parameter.fitted or (parameter.optional and parameter.name not in self.open):
                continue
            lower, upper = parameter.within or (parameter.lower, parameter.upper)
            step = STEP * parameter.step
            if parameter.typical is not None:
                step *= parameter.typical
                found.append(Coordinate(parameter.name, index, "linear", lower, upper, step, np.inf))
            else:
                low, high = np.log(max(lower, 1e-12)), np.log(max(upper, 1e-12))
                found.append(Coordinate(parameter.name, index, "log", low, high, step, np.inf))
        return found

    def start(self) -> Array:
        """Values of the coordinates for the base model's parameters and the terms' own values."""
        values = []
        for c in self.coordinates():
            if c.term < 0:
                values.append(self._first_offset(c.name))
            else:
                value = float(self.terms[c.term].values[c.name])
                values.append(value if c.scale == "linear" else np.log(max(value, 1e-12)))
        return np.array(values)

    def _first_offset(self, name: str) -> float:
        for term in self.terms:
            if term.id == "parameter_mismatch" and term.values["parameter"] == name:
                return float(np.log(float(term.values["value"]) / self.base.parameters[name]))
        return 0.0

    def model(self, theta: Array) -> Model:
        """The base model with corrected parameters and the effects at `theta`."""
        parameters = dict(self.base.parameters)
        values = [dict(term.values) for term in self.terms]
        for c, value in zip(self.coordinates(), theta, strict=True):
            if c.term < 0:
                parameters[c.name] = self.base.parameters[c.name] * float(np.exp(value))
            else:
                number = float(np.exp(value)) if c.scale == "log" else float(value)
                values[c.term][c.name] = number
        uses = []
        for term, v in zip(self.terms, values, strict=True):
            if term.id == "parameter_mismatch":
                v["value"] = parameters[str(v["parameter"])]
            uses.append(EffectUse(term.id, v))
        model = self.base.with_parameters(**parameters)
        return model.with_effects(*self.base.effects, *uses)

    def packed(self, theta: Array) -> tuple[Array, Array]:
        """Slots of the plant, and the numbers of its three sensors, at `theta`."""
        model = self.model(theta)
        return pack(model), sensors_of(model)


def undetermined(traces: Sequence[Trace]) -> tuple[str, ...]:
    """Parameters that no recording can tell: one speed alone knows nothing of a gear."""
    channels = np.any([t.has for t in traces], axis=0)
    return ("gear_ratio",) if np.count_nonzero(channels) == 1 else ()


def key_of(term: EffectUse) -> tuple[str, str]:
    """Id, and the channel or parameter that the effect speaks of ('' for none)."""
    return term.id, str(term.values.get("channel", term.values.get("parameter", "")))


def sensors_of(model: Model) -> Array:
    """The numbers of each channel's sensor (3 x as many) from a model's sensor effects; not its rounding."""
    sensors = np.stack([sensor_of(model, channel) for channel in OUTPUTS])
    sensors[:, SENSOR_STEP] = 0.0
    return sensors
