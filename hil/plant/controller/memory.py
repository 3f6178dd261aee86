"""Where the compiled firmware keeps its numbers: filter bank, gains and states, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.core.controller.bounds import MOST_DEAD_TIME_SAMPLES, MOST_SCHEDULE_POINTS
from hil.plant.controller.filters import LARGEST_ORDER, Filter

Array = npt.NDArray[np.float64]

# Filters of the bank; the last two are those of the play crossing's reference model
(
    FEEDFORWARD,
    SPEED_FILTER,
    STABILIZER,
    OBSERVER_TORQUE,
    OBSERVER_SPEED,
    WHEEL_ACCELERATION,
    TYRE_SLIP,
) = range(7)
FILTERS = 7

# Gains; what is 0 from REQUEST_RISE on is off
SAMPLE_TIME, TORQUE_LIMIT, K_I_DFC, RADIUS, SIGMA, SLIP_LIMIT, K_P, K_I = range(8)
(
    REQUEST_RISE,  # N m/s
    REQUEST_FALL,
    ZERO_BAND,  # N m
    ZERO_GRADIENT,  # N m/s
    SLIP_ALLOWED,  # |y| beyond which the request is withdrawn
    SLIP_RECOVERY,  # N m/s
    GEAR_RATIO,
    HALF_GAP,  # rad, wheel side, as all of the play crossing
    CROSSING_SPEED,  # rad/s
    CROSSING_ACCELERATION,  # rad/s²
    FOLLOW_SPEED,  # rad/s
    FOLLOW_TIME,  # s
    RELEASE_SPEED,  # rad/s
    LANDING_MARGIN,  # rad
    SHAFT_STIFFNESS,  # N m/rad
    SHAFT_DAMPING,  # N m s/rad
    ROTOR_INERTIA,  # J_m N, kg m²
    DELAY,  # dead time, samples
    CORRECTION,  # share of what the axle's twist is ahead
    PLAY_FACTOR,  # of K_p and K_i while the play is crossed
    SCHEDULE_POINTS,
) = range(8, 29)
SCHEDULE_SPEED = 29  # m/s; then the factors of K_p and K_i, and those of K_i(DFC)
WSC_FACTOR = SCHEDULE_SPEED + MOST_SCHEDULE_POINTS
DFC_FACTOR = WSC_FACTOR + MOST_SCHEDULE_POINTS
GAINS = DFC_FACTOR + MOST_SCHEDULE_POINTS

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
(
    REQUEST,  # as the gradients let it be, N m
    ROAD_LIMIT,  # largest magnitude of a request that the road is believed to bear, N m
    TWIST,  # of the reference model, gap included, rad
    TWIST_SPEED,  # rad/s
    FLANK,  # that the request belongs to: 1, -1
    SAMPLES,  # since the mode was entered
    SPEED_ERROR,  # of the wheel speed control, rad/s
    SLOW_ERROR,  # of it, what lasts
    AHEAD,  # of the reference, the axle's twist, rad
    FOLLOWED,  # what is left of the request by gradients and slip, N m
) = range(8, 18)
# What is expected of the axle, by sample: the part of ω_m that twist and tyre make (rad/s), T_s (N m)
NO_LIMIT = 1e12  # of a request, N m
EXPECTED_SPEED = 18
RING = MOST_DEAD_TIME_SAMPLES + 2
EXPECTED_TORQUE = EXPECTED_SPEED + RING
STATES = EXPECTED_TORQUE + RING

OFF, TORQUE, DRIVING_FORCE, FAULT = range(4)


@dataclass
class Memory:
    """Coefficients and states of one RMCU."""

    numerators: Array = field(default_factory=lambda: np.zeros((FILTERS, LARGEST_ORDER + 1)))
    denominators: Array = field(default_factory=lambda: _ones())
    filter_states: Array = field(default_factory=lambda: np.zeros((FILTERS, LARGEST_ORDER)))
    gains: Array = field(default_factory=lambda: np.zeros(GAINS))
    states: Array = field(default_factory=lambda: np.zeros(STATES))

    def place(self, index: int, filter_: Filter) -> None:
        """Put a filter into the bank."""
        self.numerators[index] = filter_.numerator
        self.denominators[index] = filter_.denominator


def _ones() -> Array:
    denominators = np.zeros((FILTERS, LARGEST_ORDER + 1))
    denominators[:, 0] = 1.0
    return denominators
