"""What the designer chooses, and what a design is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design._laws import DiscreteFilter, Normalisation
from hil.analysis.control_design._loop import Margins
from hil.analysis.control_design._optimize import MarginLimits, Objective, Optimum, TradeOff
from hil.analysis.control_design._plant import DesignPlant, PlantSet
from hil.core.channels import TICK_S
from hil.core.controller import Controller
from hil.core.controller.bounds import LARGEST_TORQUE_NM, SAMPLE_TIMES_S, SLOWEST_HZ
from hil.core.errors import BadInputError

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Stabilisation = Literal["phase", "gain"]

LARGEST_LEAD_DEG = 85.0  # (6) gives α = 0 at 90 degrees
LARGEST_NOTCH_WIDTH = 100.0
LARGEST_SIZE = 1e6  # of inertias, torques, times, ratios in SI units: beyond, a unit is wrong


@dataclass(frozen=True)
class DesignSpec:
    """What the designer chooses; defaults are the paper's (Table 1, sections 3.2 and 4.2)."""

    stabilisation: Stabilisation = "phase"
    pole_rad_s: float = 0.3
    lead_deg: float = 36.0
    lead_hz: float = 40.0
    normalisation: Normalisation = "high_frequency"
    notch_hz: float | None = None
    notch_width: float = 2.0
    notch_depth: float = 0.08
    inertia_kg_m2: float | None = None
    gear_ratio: float | None = None
    wheel_inertia_kg_m2: float | None = None
    torque_limit_nm: float = 150.0
    sample_time_s: float = TICK_S
    speed_filter_time_s: float = 0.05
    feed_forward_time_s: float = 0.05
    observer_time_s: float = 1 / 125.6
    dfc_integral_gain: float = 0.001
    wheel_radius_m: float = 0.33
    slip_floor_m_s: float = 1.0
    slip_limit: float = 0.2
    half_gap_rad: float | None = None
    optimise: bool = False
    objective: Objective = "max"
    limits: MarginLimits = field(default_factory=MarginLimits)
    name: str = ""

    def check(self) -> None:
        """Refuse values that make no sense.

        Raises:
            BadInputError: names the option of `hil design`, the value and the range that is allowed.
        """
        if not SAMPLE_TIMES_S[0] <= self.sample_time_s <= SAMPLE_TIMES_S[1]:
            raise BadInputError(
                f"sample_time_s is {self.sample_time_s:g}",
                fix=f"it lies from {SAMPLE_TIMES_S[0]:g} to {SAMPLE_TIMES_S[1]:g} s: the range of the RMCU",
            )
        _within(
            "--torque-limit", self.torque_limit_nm, (0.0, LARGEST_TORQUE_NM), "N m: the limit of the RMCU"
        )
        half_rate = 0.5 / self.sample_time_s
        _within("--pole", self.pole_rad_s, (0.0, 2 * np.pi * half_rate), "rad/s")
        _within("--lead-deg", self.lead_deg, (0.0, LARGEST_LEAD_DEG), "degrees")
        beyond = f"the RMCU samples at {2 * half_rate:g} Hz and cannot act faster than half of that"
        _below("--lead-hz", self.lead_hz, half_rate, beyond)
        if self.notch_hz is not None:
            _below("--notch-hz", self.notch_hz, half_rate, beyond)
        _within("--notch-width", self.notch_width, (0.0, LARGEST_NOTCH_WIDTH), "(ζ)")
        if not 0.0 <= self.notch_depth <= 1.0:
            raise BadInputError(
                f"--notch-depth is {self.notch_depth:g}",
                fix="it lies from 0 (nothing passes) to 1 (no notch)",
            )
        for option, value, unit in self._sizes():
            if value is not None:
                _within(option, value, (0.0, LARGEST_SIZE), unit)
        self._check_limits()
        if self.optimise and self.stabilisation == "gain":
            raise BadInputError("--optimize searches a lead", fix="leave out --notch-hz")

    def _sizes(self) -> tuple[tuple[str, float | None, str], ...]:
        return (
            ("--inertia", self.inertia_kg_m2, "kg m²"),
            ("--gear-ratio", self.gear_ratio, "(motor speed / wheel speed)"),
            ("--wheel-inertia", self.wheel_inertia_kg_m2, "kg m²"),
            ("--half-gap", self.half_gap_rad, "rad"),
            ("speed_filter_time_s", self.speed_filter_time_s, "s"),
            ("feed_forward_time_s", self.feed_forward_time_s, "s"),
            ("observer_time_s", self.observer_time_s, "s"),
            ("wheel_radius_m", self.wheel_radius_m, "m"),
            ("slip_floor_m_s", self.slip_floor_m_s, "m/s"),
            ("slip_limit", self.slip_limit, "(slip)"),
        )

    def _check_limits(self) -> None:
        limits = self.limits
        if not 1.0 < limits.sensitivity_peak <= LARGEST_SIZE:
            raise BadInputError(
                f"--largest-sensitivity is {limits.sensitivity_peak:g}",
                fix="give a value above 1; |S| reaches at least 1 in every loop, and 1.5 to 2 is usual",
            )
        _within("gain_margin_db", limits.gain_margin_db, (0.0, LARGEST_SIZE), "dB")
        _within("phase_margin_deg", limits.phase_margin_deg, (0.0, 180.0), "degrees")
        _within("delay_margin_s", limits.delay_margin_s, (0.0, 1.0), "s")


def _within(option: str, value: float, bounds: tuple[float, float], unit: str) -> None:
    """Refuse what is not above the lower and at most at the upper bound; NaN and infinity are neither."""
    low, high = bounds
    if not low < value <= high:
        number = "positive number" if low == 0.0 else f"number above {low:g}"
        raise BadInputError(f"{option} is {value:g}", fix=f"give a {number} of at most {high:.6g} {unit}")


def _below(option: str, value_hz: float, half_rate_hz: float, why: str) -> None:
    if not SLOWEST_HZ <= value_hz < half_rate_hz:
        raise BadInputError(
            f"{option} is {value_hz:g}",
            fix=f"it lies from {SLOWEST_HZ:g} to below {half_rate_hz:g} Hz: {why}",
        )


@dataclass(frozen=True)
class Loop:
    """One open loop on the design's grid, as the RMCU closes it (sampled, held) and as in continuous time."""

    name: str
    sampled: ComplexArray
    continuous: ComplexArray
    margins: Margins
    continuous_margins: Margins


@dataclass(frozen=True)
class Robustness:
    """The worst over all possible plants, as sampled."""

    source: str
    stable_share: float
    sensitivity_peak: float
    comfort_peak: float
    gain_margin_db: float
    phase_margin_deg: float
    delay_margin_s: float


@dataclass(frozen=True)
class Design:
    """The controller and the evidence for it.

    `loops` are, in this order: plant alone, PI, phase (PI and lead), gain (PI and notch), all on the
    grid `frequency_hz`; `chosen` names the one that the controller closes. `discrete` holds the RMCU's
    filters by name. `warnings` are plain sentences on what the stable loop lacks; none when it is good.
    """

    controller: Controller
    plant: DesignPlant
    spec: DesignSpec
    frequency_hz: Array
    loops: tuple[Loop, ...]
    chosen: str
    trade_off: TradeOff
    robustness: Robustness
    plants: PlantSet
    optimum: Optimum | None
    discrete: dict[str, DiscreteFilter]
    notes: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    def loop(self, name: str) -> Loop:
        """One of the loops; KeyError if there is none of that name."""
        for loop in self.loops:
            if loop.name == name:
                return loop
        raise KeyError(name)
