"""Search of lead and pole for the lowest sensitivity in 8-20 Hz, under margin limits, for all plants.

The trade-off (Fig. 10) is phase at the resonance against the sensitivity peak, over lead angle and
frequency.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design._laws import Normalisation, lead, lead_function, pole_assignment
from hil.analysis.control_design._loop import comfort, encirclements, feedback_response, margins
from hil.core.errors import BadInputError
from hil.core.model import TransferFunction

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

Objective = Literal["max", "rms"]
_ANGLES = (0.0, 12.0, 24.0, 36.0, 48.0, 60.0, 70.0)
_FREQUENCIES = (10.0, 15.0, 22.0, 32.0, 45.0, 65.0, 100.0)
_POLES = (0.1, 0.15, 0.22, 0.3, 0.45, 0.65, 1.0)
_NORMALISATIONS: tuple[Normalisation, ...] = ("dc", "centre", "high_frequency")
_VIOLATION_ALLOWED = 0.005
_BOUNDS = ((0.0, 75.0), (8.0, 150.0), (0.05, 1.0))


@dataclass(frozen=True)
class MarginLimits:
    """What every possible plant must keep."""

    sensitivity_peak: float = 1.8
    gain_margin_db: float = 6.0
    phase_margin_deg: float = 35.0
    delay_margin_s: float = 0.001


@dataclass(frozen=True)
class Optimum:
    """The best lead and pole.

    `objective` is the worst value over all plants of what was minimised; `evaluations` counts loops.
    """

    angle_deg: float
    frequency_hz: float
    pole_rad_s: float
    normalisation: Normalisation
    objective: float
    evaluations: int


def optimize(
    frequency_hz: Array,
    plants: ComplexArray,
    inertia_kg_m2: float,
    sample_time_s: float | None,
    *,
    limits: MarginLimits | None = None,
    objective: Objective = "max",
    origin_poles: int = 2,
    progress: Callable[[str], None] = lambda _: None,
) -> Optimum:
    """Minimise |S| over 8-20 Hz: its largest value, or its rms; the worst of all plants counts.

    A grid over angle, frequency, pole and normalisation on the first plant finds where to start; the
    best few starts are refined (Nelder-Mead) on all plants with the limits as penalties.

    Args:
        frequency_hz: F frequencies of a dense grid.
        plants: D x F motor speed responses, hold included where sampled.
        inertia_kg_m2: of (4)(5).
        sample_time_s: Tustin's rule at this sample time; None for continuous.
        limits: what all plants must keep.
        objective: 'max' or 'rms'.
        origin_poles: poles of the open loop at the origin.
        progress: called with what is being done.

    Raises:
        BadInputError: nothing keeps the limits.
    """
    keep = limits or MarginLimits()
    search = _Search(frequency_hz, plants, inertia_kg_m2, sample_time_s, keep, objective, origin_poles)
    progress("grid")
    starts: list[tuple[float, tuple[float, float, float, Normalisation]]] = []
    for choice in itertools.product(_ANGLES, _FREQUENCIES, _POLES, _NORMALISATIONS):
        starts.append((search.penalised(choice[:3], choice[3], plants[:1], exact=False), choice))
    starts.sort(key=lambda start: start[0])
    found: list[tuple[float, tuple[float, float, float], Normalisation]] = []
    for normalisation in _NORMALISATIONS:
        progress(f"refining, normalised at {normalisation.replace('_', ' ')}")
        for value, choice in [s for s in starts if s[1][3] == normalisation][:2]:
            if np.isfinite(value):
                found.append((*search.refine(choice[:3], normalisation), normalisation))
    for _, refined, normalisation in sorted(found, key=lambda one: one[0]):
        if search.violation(refined, normalisation) <= _VIOLATION_ALLOWED:
            angle, centre, pole = refined
            value = search.value(refined, normalisation, plants)
            return Optimum(angle, centre, pole, normalisation, value, search.evaluations)
    raise BadInputError(
        f"no lead keeps |S| <= {keep.sensitivity_peak:g}, {keep.gain_margin_db:g} dB, "
        f"{keep.phase_margin_deg:g} degrees and {keep.delay_margin_s * 1e3:g} ms for all plants",
        fix="relax the limits, or identify the plant more closely",
    )


class _Search:
    """Objective and limits of one choice of (angle, frequency, pole, normalisation)."""

    def __init__(
        self,
        frequency_hz: Array,
        plants: ComplexArray,
        inertia_kg_m2: float,
        sample_time_s: float | None,
        limits: MarginLimits,
        objective: Objective,
        origin_poles: int,
    ) -> None:
        self._frequency_hz = frequency_hz
        self._plants = plants
        self._inertia = inertia_kg_m2
        self._step = sample_time_s
        self._limits = limits
        self._objective = objective
        self._origin_poles = origin_poles
        self.evaluations = 0

    def _loops(
        self, choice: tuple[float, float, float], normalisation: Normalisation, plants: ComplexArray
    ) -> ComplexArray:
        angle, centre, pole = choice
        gain, integral = pole_assignment(self._inertia, pole)
        blocks = (
            TransferFunction((gain, integral), (1.0, 0.0)),
            lead_function(lead(angle, centre, normalisation)),
        )
        self.evaluations += len(plants)
        return plants * feedback_response(blocks, self._frequency_hz, self._step)

    def value(
        self, choice: tuple[float, float, float], normalisation: Normalisation, plants: ComplexArray
    ) -> float:
        """The worst plant's objective."""
        loops = self._loops(choice, normalisation, plants)
        which = 0 if self._objective == "max" else 1
        return max(comfort(self._frequency_hz, 1 / np.abs(1 + loop))[which] for loop in loops)

    def penalised(
        self,
        choice: tuple[float, float, float],
        normalisation: Normalisation,
        plants: ComplexArray,
        *,
        exact: bool = True,
    ) -> float:
        """Objective plus ten times the violation; infinite when unstable.

        Without `exact` only stability and the sensitivity peak are looked at.
        """
        loops = self._loops(choice, normalisation, plants)
        if np.any(encirclements(loops, self._origin_poles)):
            return float("inf")
        peak = float(np.max(1 / np.abs(1 + loops)))
        violation = max(0.0, peak / self._limits.sensitivity_peak - 1)
        if exact:
            # Margins of every plant would take seconds; |S| above bounds them all, a few show the rest.
            violation += self.violation(choice, normalisation, loops[:: max(1, len(loops) // 6)])
        which = 0 if self._objective == "max" else 1
        worst = max(comfort(self._frequency_hz, 1 / np.abs(1 + loop))[which] for loop in loops)
        return worst + 10 * violation

    def violation(
        self,
        choice: tuple[float, float, float],
        normalisation: Normalisation,
        loops: ComplexArray | None = None,
    ) -> float:
        """Sum of the relative violations of all limits by the worst plant; infinite when unstable."""
        if loops is None:
            loops = self._loops(choice, normalisation, self._plants)
        worst = 0.0
        for loop in loops:
            m = margins(self._frequency_hz, loop, self._origin_poles)
            if not m.stable:
                return float("inf")
            worst = max(
                worst,
                max(0.0, m.sensitivity_peak / self._limits.sensitivity_peak - 1)
                + max(0.0, 1 - m.gain_margin_db / self._limits.gain_margin_db)
                + max(0.0, 1 - m.phase_margin_deg / self._limits.phase_margin_deg)
                + max(0.0, 1 - m.delay_margin_s / self._limits.delay_margin_s),
            )
        return worst

    def refine(
        self, start: tuple[float, float, float], normalisation: Normalisation
    ) -> tuple[float, tuple[float, float, float]]:
        """Nelder-Mead on all plants from one start."""
        from scipy.optimize import minimize

        def cost(x: Array) -> float:
            value = self.penalised(_inside(x), normalisation, self._plants)
            return value if np.isfinite(value) else 1e3

        x0 = np.array([start[0], np.log(start[1]), np.log(start[2])])
        simplex = x0 + np.vstack([np.zeros(3), np.diag([6.0, 0.2, 0.2])])
        solution = minimize(
            cost,
            x0,
            method="Nelder-Mead",
            options={"initial_simplex": simplex, "xatol": 0.02, "fatol": 1e-5, "maxfev": 160},
        )
        return float(solution.fun), _inside(solution.x)


def _inside(x: Array) -> tuple[float, float, float]:
    values = (float(x[0]), float(np.exp(x[1])), float(np.exp(x[2])))
    angle, centre, pole = (min(max(v, low), high) for v, (low, high) in zip(values, _BOUNDS, strict=True))
    return angle, centre, pole


LEAD_ANGLES_DEG = tuple(float(a) for a in range(0, 65, 6))
LEAD_FREQUENCIES_HZ = (15.0, 20.0, 30.0, 40.0, 60.0, 80.0)


@dataclass(frozen=True)
class TradeOff:
    """One value for each lead angle (A) and lead frequency (B).

    `phase_deg` is the open loop's phase at the resonance, `sensitivity_peak` the largest |S| and
    `resonance_sensitivity` |S| at the resonance (A x B); both are NaN where the loop is unstable.
    """

    angles_deg: Array
    frequencies_hz: Array
    phase_deg: Array
    sensitivity_peak: Array
    resonance_sensitivity: Array


def trade_off(
    frequency_hz: Array,
    pi_loop: ComplexArray,
    resonance_hz: float,
    normalisation: Normalisation,
    sample_time_s: float | None,
    *,
    origin_poles: int = 2,
) -> TradeOff:
    """Evaluate every lead on the open loop with PI control.

    Args:
        frequency_hz: F frequencies of a dense grid.
        pi_loop: F values of the open loop with the PI controller alone.
        resonance_hz: where the phase is read.
        normalisation: the lead's.
        sample_time_s: Tustin's rule at this sample time; None for continuous.
        origin_poles: poles of the open loop at the origin.
    """
    shape = (len(LEAD_ANGLES_DEG), len(LEAD_FREQUENCIES_HZ))
    phase, peak, at_resonance = np.empty(shape), np.empty(shape), np.empty(shape)
    for a, angle in enumerate(LEAD_ANGLES_DEG):
        for b, centre in enumerate(LEAD_FREQUENCIES_HZ):
            part = lead_function(lead(angle, centre, normalisation))
            loop = pi_loop * feedback_response((part,), frequency_hz, sample_time_s)
            sensitivity = 1 / np.maximum(np.abs(1 + loop), 1e-300)
            stable = encirclements(loop, origin_poles) == 0
            here = np.interp(resonance_hz, frequency_hz, loop)
            phase[a, b] = np.degrees(np.angle(here))
            peak[a, b] = np.max(sensitivity) if stable else np.nan
            at_resonance[a, b] = 1 / abs(1 + here) if stable else np.nan
    return TradeOff(np.array(LEAD_ANGLES_DEG), np.array(LEAD_FREQUENCIES_HZ), phase, peak, at_resonance)
