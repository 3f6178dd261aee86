"""Controller files: everything the RMCU needs for Fig. 3 of the paper, in SI units.

Names follow the paper; equation numbers are the paper's. `plant` holds the identified functions
without their dead time, from which the RMCU builds the filters (17) and (18).
"""

from __future__ import annotations

import logging
import math
from pathlib import Path
from typing import Annotated, Any, Literal

import tomli_w
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from hil.core.controller.bounds import (
    MOST_DEAD_TIME_SAMPLES,
    Alpha,
    Depth,
    Frequency,
    Gain,
    Inertia,
    Radius,
    Ratio,
    SampleTime,
    SlipFloor,
    SlipLimit,
    TimeConstant,
    Torque,
    Width,
    coefficients_checked,
    denominator_checked,
    too_fast,
)
from hil.core.controller.shaping import Play, RequestLimits, Schedule, SlipWithdrawal
from hil.core.errors.mistakes import Mistake, keyed, mistakes_of, refuse
from hil.core.files import write_atomically
from hil.core.files.toml_file import FORMAT, FormatNumber, parse_toml, refuse_other_kind, toml_text

logger = logging.getLogger(__name__)

LARGEST_ORDER = 7
#: Lists of TOML, whose entries are numbers.
_Tuple = Annotated[tuple[float, ...], Field(strict=False)]
Coefficients = Annotated[
    _Tuple, Field(min_length=1, max_length=LARGEST_ORDER + 1), AfterValidator(coefficients_checked)
]
Denominator = Annotated[
    _Tuple, Field(min_length=2, max_length=LARGEST_ORDER + 1), AfterValidator(denominator_checked)
]


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Dfc(_Table):
    """Driving force control: feedback with (1)(2), feed-forward (18)."""

    integral_gain: Gain = Field(description="K_i(DFC), 1/(N m s)")
    feedforward_time_constant_s: TimeConstant = Field(description="τ_2 of (18)")
    wheel_radius_m: Radius = 0.33
    slip_floor_m_s: SlipFloor = Field(1.0, description="σ of (1)")
    slip_limit: SlipLimit = Field(0.2, description="largest |y|, the integrator's anti-windup")


class Lead(_Table):
    """Phase lead, gain·(T s + 1)/(α T s + 1), (6)(7)."""

    alpha: Alpha
    time_constant_s: TimeConstant = Field(description="T")
    normalisation: Literal["dc", "centre", "high_frequency"] = "high_frequency"

    @property
    def gain(self) -> float:
        """Factor that makes the gain one at DC, at the lead frequency or at high frequency."""
        exponent = {"dc": 0.0, "centre": 0.5, "high_frequency": 1.0}[self.normalisation]
        return float(self.alpha**exponent)

    @property
    def frequency_hz(self) -> float:
        """f_ph of (7), where the lead is largest."""
        return 1 / (2 * math.pi * math.sqrt(self.alpha) * self.time_constant_s)


class Notch(_Table):
    """Notch filter (8)."""

    frequency_hz: Frequency = Field(description="f_n")
    width: Width = Field(description="ζ")
    depth: Depth = Field(description="d")


class Wsc(_Table):
    """Wheel speed control: PI (4)(5), filter (17), lead or notch or neither."""

    proportional_gain: Gain = Field(description="K_p, N m s/rad")
    integral_gain: Gain = Field(description="K_i, N m/rad")
    filter_time_constant_s: TimeConstant = Field(description="τ_1 of (17)")
    lead: Lead | None = None
    notch: Notch | None = None

    @model_validator(mode="after")
    def _one_of(self) -> Wsc:
        if self.lead is not None and self.notch is not None:
            raise ValueError("give [wsc.lead] or [wsc.notch], not both")
        return self


class Dfo(_Table):
    """Driving force observer (9)-(13)."""

    time_constant_s: TimeConstant = Field(description="τ_DFO")
    gear_ratio: Ratio = Field(description="N")
    wheel_inertia_kg_m2: Inertia = Field(description="J_l between T_s and the road: wheels and dyno rotors")


class Plant(_Table):
    """Polynomials in descending powers of s, one common denominator, no dead time."""

    denominator: Denominator
    motor_speed: Coefficients = Field(description="(14)")
    wheel_speed: Coefficients = Field(description="(15)")
    shaft_torque: Coefficients = Field(description="(16)")


class Controller(_Table):
    """One controller file."""

    format: FormatNumber = FORMAT
    name: str = Field(min_length=1)
    sample_time_s: SampleTime = 0.001
    torque_limit_nm: Torque = Field(description="largest |T_m*|")
    dfc: Dfc
    wsc: Wsc
    dfo: Dfo
    plant: Plant
    request: RequestLimits | None = None
    slip: SlipWithdrawal | None = None
    play: Play | None = None
    schedule: Schedule | None = None
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
        controller = Controller.model_validate(data)
    except ValidationError as error:
        refuse(where, map(keyed, mistakes_of(error, Controller)), text)
        raise
    refuse(where, _contradictions(controller), text)
    return controller


def _contradictions(controller: Controller) -> list[Mistake]:
    """Numbers that are possible one by one, and of which the RMCU can make no filter together."""
    wsc, plant = controller.wsc, controller.plant
    places_hz = {"wsc.lead.time_constant_s": wsc.lead.frequency_hz} if wsc.lead is not None else {}
    if wsc.notch is not None:
        places_hz["wsc.notch.frequency_hz"] = wsc.notch.frequency_hz
    found = [Mistake(key, what) for key, what in too_fast(places_hz, controller.sample_time_s)]
    for key, over, equation, above, below in (
        ("wheel_speed", "motor_speed", "(17)", plant.motor_speed, plant.wheel_speed),
        ("shaft_torque", "denominator", "(18)", plant.denominator, plant.shaft_torque),
    ):
        if _order(above) > _order(below) + 1:
            what = (
                f"plant.{key} is of order {_order(below)}, plant.{over} of order {_order(above)}: "
                f"the filter {equation} would be improper"
            )
            found.append(Mistake(f"plant.{key}", what, f"give at least order {_order(above) - 1}"))
    if controller.play is not None and controller.play.dead_time_s > (
        longest_s := MOST_DEAD_TIME_SAMPLES * controller.sample_time_s
    ):
        what = (
            f"play.dead_time_s is {controller.play.dead_time_s:g}: the RMCU waits for {longest_s:g} s at most"
        )
        fix = f"it remembers {MOST_DEAD_TIME_SAMPLES} samples; give a longer sample_time_s"
        found.append(Mistake("play.dead_time_s", what, fix))
    return found


def _order(polynomial: tuple[float, ...]) -> int:
    """Of the highest power of s that is there."""
    return max(power for power, value in enumerate(reversed(polynomial)) if value)


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
