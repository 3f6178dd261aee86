"""An effect near one size, and the scene that sizes are taken from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]
Values = dict[str, float | str]


@dataclass(frozen=True)
class Direction:
    """The plant with an effect of some size, and how many of these may be added linearly."""

    values: Values
    lower: float = 1.0
    upper: float = 1.0


@dataclass(frozen=True)
class Probe:
    """An effect near one size: its response is Σ αᵢ·directionᵢ; `start` makes values from the αs."""

    id: str
    directions: tuple[Direction, ...]
    start: Callable[[Array], Values]

    def use(self, amounts: Array) -> EffectUse:
        """The effect with the values that `amounts` of the directions stand for."""
        return EffectUse(self.id, self.start(amounts))


@dataclass(frozen=True)
class Scene:
    """What the sizes of probes are taken from."""

    problem: Problem
    fit: Fit

    @property
    def model(self) -> Model:
        """The base model with corrected parameters."""
        return self.fit.hypothesis.model(self.fit.theta)

    @property
    def torque(self) -> float:
        """Largest requested torque, N m."""
        return max(float(np.max(np.abs(t.torque))) for t in self.problem.traces)

    @property
    def shaft_torque(self) -> float:
        """Largest shaft torque, N m, by the model where it was not measured."""
        found = 0.0
        for t in self.problem.traces:
            high = np.nanmax(np.abs(t.measured[:, 2])) if np.isfinite(t.measured[0, 2]) else 0.0
            found = max(found, float(high))
        return found or 0.7 * self.torque * self.model.parameters["gear_ratio"]
