"""What the designer chooses, and what a design is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design._discretise import DiscreteFilter
from hil.analysis.control_design._laws import Normalisation
from hil.analysis.control_design._loop import Margins
from hil.analysis.control_design._optimize import MarginLimits, Objective, Optimum
from hil.analysis.control_design._plant import DesignPlant
from hil.analysis.control_design._trade_off import TradeOff
from hil.analysis.control_design._uncertainty import PlantSet
from hil.core.controller import Controller
from hil.core.errors import BadInputError

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Stabilisation = Literal["phase", "gain"]


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
    sample_time_s: float = 0.001
    speed_filter_time_s: float = 0.05
    feed_forward_time_s: float = 0.05
    observer_time_s: float = 1 / 125.6
    dfc_integral_gain: float = 0.001
    wheel_radius_m: float = 0.33
    slip_floor_m_s: float = 1.0
    slip_limit: float = 0.2
    optimise: bool = False
    objective: Objective = "max"
    limits: MarginLimits = field(default_factory=MarginLimits)
    name: str = ""

    def check(self) -> None:
        """Refuse values that make no sense.

        Raises:
            BadInputError: names the option of `hil design`.
        """
        positive: dict[str, float | None] = {
            "--pole": abs(self.pole_rad_s),
            "--sample-time": self.sample_time_s,
            "--torque-limit": self.torque_limit_nm,
            "--inertia": self.inertia_kg_m2,
            "--gear-ratio": self.gear_ratio,
            "--wheel-inertia": self.wheel_inertia_kg_m2,
            "--notch-hz": self.notch_hz,
        }
        for option, value in positive.items():
            if value is not None and not (np.isfinite(value) and value > 0):
                raise BadInputError(f"{option} is {value:g}", fix="give a positive number")
        if self.optimise and self.stabilisation == "gain":
            raise BadInputError("--optimize searches a lead", fix="leave out --notch-hz")


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
    filters by name.
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

    def loop(self, name: str) -> Loop:
        """One of the loops; KeyError if there is none of that name."""
        for loop in self.loops:
            if loop.name == name:
                return loop
        raise KeyError(name)
