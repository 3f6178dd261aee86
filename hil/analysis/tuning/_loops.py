"""Stability margins of candidates on every car: the speed loop as the RMCU closes it."""

from __future__ import annotations

import copy
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design import (
    Margins,
    feedback_functions,
    feedback_response,
    hold_response,
    loop_grid,
    margins,
)
from hil.core.channels import OUTPUTS
from hil.core.controller import Controller
from hil.core.model import Model
from hil.plant import LinearSystem, linear_system

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_COUNT = 900  # frequencies
_FOLDS = 20  # of aliasing; what is beyond has fallen off with the square of their number


class SpeedLoops:
    """Open loops of the wheel speed control around each of `models`, their linear effects included."""

    def __init__(self, models: Sequence[Model], sample_time_s: float) -> None:
        self._step = sample_time_s
        self.frequency_hz = loop_grid(sample_time_s, _COUNT)
        systems = [linear_system(model) for model in models]
        seen = self._sampled(systems[0]) / self._held(systems[0])
        # Aliasing is small: that of the first model is that of its neighbours.
        self._plants = [self._held(system) * seen for system in systems]
        self._origin_poles = [1 if _has_drag(model) else 2 for model in models]

    def of(self, numbers: Sequence[int]) -> SpeedLoops:
        """Those around some of the models alone, in this order."""
        some = copy.copy(self)
        some._plants = [self._plants[number] for number in numbers]
        some._origin_poles = [self._origin_poles[number] for number in numbers]
        return some

    @property
    def plants(self) -> ComplexArray:
        """Sampled motor speed responses, models x frequencies."""
        return np.array(self._plants)

    @property
    def origin_poles(self) -> tuple[int, ...]:
        """Of the open loop around each model: the controller's and the axle's own."""
        return tuple(self._origin_poles)

    def margins(self, controller: Controller, number: int) -> Margins:
        """Of the loop that `controller` closes around model `number`; of a schedule, where |S| is largest."""
        factors = {1.0} if controller.schedule is None else set(controller.schedule.wsc_factor) - {0.0}
        found = [self.margins_with(controller, number, factor) for factor in sorted(factors or {1.0})]
        return max(found, key=lambda one: (not one.stable, one.sensitivity_peak))

    def margins_with(self, controller: Controller, number: int, factor: float) -> Margins:
        """Of the loop around model `number` with K_p and K_i times `factor`."""
        loop = factor * self.open_loop(controller, number)
        return margins(self.frequency_hz, loop, self._origin_poles[number])

    def open_loop(self, controller: Controller, number: int) -> ComplexArray:
        """F values on `frequency_hz`."""
        blocks = feedback_functions(controller.wsc)
        return np.asarray(self._plants[number] * feedback_response(blocks, self.frequency_hz, self._step))

    def _held(self, system: LinearSystem) -> ComplexArray:
        return _motor_speed(system, self.frequency_hz) * hold_response(self.frequency_hz, self._step)

    def _sampled(self, system: LinearSystem) -> ComplexArray:
        """With what sampling folds back: the sum over k of P(f + k/T) hold(f + k/T)."""
        total = np.zeros(self.frequency_hz.shape, complex)
        for fold in range(-_FOLDS, _FOLDS + 1):
            folded = self.frequency_hz + fold / self._step
            total += _motor_speed(system, folded) * hold_response(folded, self._step)
        return total


def _motor_speed(system: LinearSystem, frequency_hz: Array) -> ComplexArray:
    return np.asarray(system.response(frequency_hz)[system.outputs.index(OUTPUTS[0])])


def _has_drag(model: Model) -> bool:
    """Whether the axle slows down by itself: its speed then has no pole at the origin."""
    drag = model.parameters.get("viscous_drag", 0.0) > 0
    return drag or any(use.id == "viscous_drag" for use in model.effects)
