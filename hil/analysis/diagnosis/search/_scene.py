"""The scene that recordings set: what the sizes of probes are taken from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._orders import order_lines
from hil.core.channels import OUTPUTS
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
