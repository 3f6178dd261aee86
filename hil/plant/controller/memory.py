"""Where the compiled firmware keeps its numbers: filter bank, gains and states, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.plant.controller.filters import LARGEST_ORDER, Filter

Array = npt.NDArray[np.float64]

# Filters of the bank
FEEDFORWARD, SPEED_FILTER, STABILIZER, OBSERVER_TORQUE, OBSERVER_SPEED = range(5)

# Gains
SAMPLE_TIME, TORQUE_LIMIT, K_I_DFC, RADIUS, SIGMA, SLIP_LIMIT, K_P, K_I = range(8)

# States; the last three are what the control came to in between, for whoever looks into the memory: T_m(DFC)*
# and T_m(WSC)* in N m, ω_l* in rad/s
(
    SLIP,
    INTEGRATOR,
    MODE,
    ESTIMATE,
    SATURATED,
    FEEDFORWARD_TORQUE,
    FEEDBACK_TORQUE,
    WHEEL_REFERENCE,
) = range(8)

OFF, TORQUE, DRIVING_FORCE, FAULT = range(4)


@dataclass
class Memory:
    """Coefficients and states of one RMCU."""

    numerators: Array = field(default_factory=lambda: np.zeros((5, LARGEST_ORDER + 1)))
    denominators: Array = field(default_factory=lambda: _ones())
    filter_states: Array = field(default_factory=lambda: np.zeros((5, LARGEST_ORDER)))
    gains: Array = field(default_factory=lambda: np.zeros(8))
    states: Array = field(default_factory=lambda: np.zeros(8))

    def place(self, index: int, filter_: Filter) -> None:
        """Put a filter into the bank."""
        self.numerators[index] = filter_.numerator
        self.denominators[index] = filter_.denominator


def _ones() -> Array:
    denominators = np.zeros((5, LARGEST_ORDER + 1))
    denominators[:, 0] = 1.0
    return denominators
