"""Controller files: everything the RMCU needs for Fig. 3 of the paper, in SI units.

Names follow the paper; equation numbers are the paper's. `plant` holds the identified functions
without their dead time, from which the RMCU builds the filters (17) and (18).
"""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any, Literal

import tomli_w
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from hil.core.file_format import FORMAT, FormatNumber
from hil.core.file_kind import refuse_other_kind
from hil.core.files import write_atomically
from hil.core.mistakes import keyed, refuse
from hil.core.table_mistakes import told
from hil.core.toml_file import parse_toml, toml_text

logger = logging.getLogger(__name__)

LARGEST_ORDER = 7
Coefficients = tuple[float, ...]


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Dfc(_Table):
    """Driving force control: feedback with (1)(2), feed-forward (18)."""

    integral_gain: float = Field(ge=0, description="K_i(DFC), 1/(N m s)")
    feedforward_time_constant_s: float = Field(gt=0, description="τ_2 of (18)")
    wheel_radius_m: float = Field(0.33, gt=0)
    slip_floor_m_s: float = Field(1.0, gt=0, description="σ of (1)")
    slip_limit: float = Field(0.2, ge=0, description="largest |y|, the integrator's anti-windup")


class Lead(_Table):
    """Phase lead, gain·(T s + 1)/(α T s + 1), (6)(7)."""

    alpha: float = Field(gt=0, le=1)
    time_constant_s: float = Field(gt=0, description="T")
    normalisation: Literal["dc", "centre", "high_frequency"] = "high_frequency"

    @property
    def gain(self) -> float:
        """Factor that makes the gain one at DC, at the lead frequency or at high frequency."""
        exponent = {"dc": 0.0, "centre": 0.5, "high_frequency": 1.0}[self.normalisation]
        return float(self.alpha**exponent)


class Notch(_Table):
    """Notch filter (8)."""

    frequency_hz: float = Field(gt=0, description="f_n")
    width: float = Field(gt=0, description="ζ")
    depth: float = Field(ge=0, description="d")


class Wsc(_Table):
    """Wheel speed control: PI (4)(5), filter (17), lead or notch or neither."""

    proportional_gain: float = Field(ge=0, description="K_p, N m s/rad")
    integral_gain: float = Field(ge=0, description="K_i, N m/rad")
    filter_time_constant_s: float = Field(gt=0, description="τ_1 of (17)")
    lead: Lead | None = None
    notch: Notch | None = None

    @model_validator(mode="after")
    def _one_of(self) -> Wsc:
        if self.lead is not None and self.notch is not None:
            raise ValueError("give [wsc.lead] or [wsc.notch], not both")
        return self


class Dfo(_Table):
    """Driving force observer (9)-(13)."""

    time_constant_s: float = Field(gt=0, description="τ_DFO")
    gear_ratio: float = Field(gt=0, description="N")
    wheel_inertia_kg_m2: float = Field(
        gt=0, description="J_l between T_s and the road: wheels and dyno rotors"
    )


class Plant(_Table):
    """Polynomials in descending powers of s, one common denominator, no dead time."""

    denominator: Coefficients = Field(min_length=2, max_length=LARGEST_ORDER + 1)
    motor_speed: Coefficients = Field(min_length=1, max_length=LARGEST_ORDER + 1, description="(14)")
    wheel_speed: Coefficients = Field(min_length=1, max_length=LARGEST_ORDER + 1, description="(15)")
    shaft_torque: Coefficients = Field(min_length=1, max_length=LARGEST_ORDER + 1, description="(16)")


class Controller(_Table):
    """One controller file."""

    format: FormatNumber = FORMAT
    name: str = Field(min_length=1)
    sample_time_s: float = Field(0.001, gt=0)
    torque_limit_nm: float = Field(gt=0, description="largest |T_m*|")
    dfc: Dfc
    wsc: Wsc
    dfo: Dfo
    plant: Plant
    meta: dict[str, Any] = {}

    @property
    def stabilization(self) -> str:
        """'phase' with a lead, 'gain' with a notch, else 'none'."""
        return "phase" if self.wsc.lead else "gain" if self.wsc.notch else "none"


def load_controller(path: Path) -> Controller:
    """Read a controller file.

    Raises:
        BadInputError: names every key that is unknown, missing or out of range.
    """
    controller = controller_from_toml(toml_text(path), str(path))
    logger.debug("controller %s", path)
    return controller


def controller_from_toml(text: str, where: str) -> Controller:
    """Check the text of a controller file; `where` names it in messages.

    Raises:
        BadInputError: not TOML, or every key that is unknown, missing or out of range.
    """
    try:
        data = parse_toml(text, where)
        refuse_other_kind(data, "controller", where)
        return Controller.model_validate(data)
    except ValidationError as error:
        refuse(where, map(keyed, told(error, Controller)), text)
        raise


def controller_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a controller file, for editors."""
    draft = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {**draft, **Controller.model_json_schema(), "title": "Controller file"}


def save_controller(controller: Controller, path: Path) -> None:
    """Write a controller file that `load_controller` reads back."""
    write_atomically(path, controller_to_toml(controller))


def controller_to_toml(controller: Controller) -> str:
    """The text of a controller file."""
    return tomli_w.dumps(controller.model_dump(exclude_none=True))
