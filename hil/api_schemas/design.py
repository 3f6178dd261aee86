"""Models, controllers and drafts of controllers, as they pass over the API."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.api_schemas.api import Number, PlanName

FileName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")]
Numbers = list[float | None]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class ModelData(_Data):
    """A model for design and diagnosis."""

    name: str
    kind: str
    built_in: bool
    effects: list[str]
    warning: str = Field("", description="warning in the model's file")


class ControllerData(_Data):
    """A controller that plans can load."""

    name: str
    built_in: bool
    stabilisation: str
    warnings: list[str]


class DraftWanted(_Data):
    """Design parameters; defaults are the paper's, bounds those of `hil design`."""

    model: FileName
    stabilisation: Literal["phase", "gain"] = "phase"
    pole_rad_s: Number = 0.3
    lead_deg: Number = Field(36.0, description="phase lead P_h (equation 6)")
    lead_hz: Number = Field(40.0, description="centre frequency of the lead f_ph (equation 7)")
    normalisation: Literal["dc", "centre", "high_frequency"] = "high_frequency"
    notch_hz: Number | None = Field(None, description="null: at the model's resonance")
    notch_width: Number = 2.0
    notch_depth: Number = 0.08
    torque_limit_nm: Number = 150.0
    name: FileName | None = Field(None, description="of the controller")


class MarginData(_Data):
    """Stability margins of the loop that the RMCU closes; null without a crossing."""

    gain_margin_db: float | None
    gain_margin_hz: float | None
    phase_margin_deg: float | None
    phase_margin_hz: float | None
    delay_margin_s: float | None
    sensitivity_peak: float | None
    sensitivity_peak_hz: float | None
    comfort_peak: float | None = Field(description="largest |S| in 8-20 Hz")
    stable: bool


class DraftLoop(_Data):
    """An open loop L over the draft's frequencies, and |S| = |1/(1 + L)|."""

    name: Literal["pi", "chosen"]
    real: Numbers
    imaginary: Numbers
    sensitivity: Numbers


class DraftStep(_Data):
    """A step of driving torque, simulated with the controller and the model's nonlinear effects."""

    speed_km_h: float
    shaft_torque_nm: Numbers
    peak_shaft_torque_nm: float | None
    overshoot_shaft_torque_nm: float | None


class DraftData(_Data):
    """A draft of a controller, evaluated on the nominal model."""

    frequency_hz: list[float]
    loops: list[DraftLoop]
    margins: MarginData
    unstable: str = Field(description="reason of instability; '' if the loop is stable")
    resonance_hz: float
    step_nm: float
    time_s: list[float] = Field(description="of the steps, which are at 0")
    steps: list[DraftStep]
    steps_why_not: str = Field(description="reason why no step was simulated")
    notes: list[str]


class CloudWanted(DraftWanted):
    """A draft on cars that are drawn around its model."""

    cars: int = Field(40, ge=1, le=200)
    tolerance: dict[str, Number] | None = Field(
        None,
        max_length=20,
        description="half widths, relative, by the model's parameters, and `dead_time_s`; null: those of the "
        "model's file, or as `hil tune`; the model's standard errors are drawn from in any case",
    )
    seed: int = Field(1, ge=0, le=2**31 - 1)


class CarFigures(_Data):
    """A draft on one car."""

    margins: MarginData
    overshoot_nm: Numbers = Field(description="of the shaft torque, at the speeds of the draft's steps")
    band_energy: float | None = Field(
        description="of the motor speed in 8-20 Hz around the step at 20 km/h, (rad/s)²"
    )
    differs: dict[str, float] = Field(description="numbers of this car that are not the model's")


class CloudLoop(_Data):
    """A car's open loop."""

    real: Numbers
    imaginary: Numbers


class CloudData(_Data):
    """A draft on the model itself (first) and on the cars drawn around it."""

    source: str = Field(description="where the cars come from")
    frequency_hz: list[float]
    loops: list[CloudLoop]
    sensitivity_lower: Numbers = Field(description="smallest |S| of all cars at each frequency")
    sensitivity_upper: Numbers
    worst: int = Field(description="place of the car that is unstable or has the largest |S|")
    worst_sensitivity: Numbers
    cars: list[CarFigures]
    steps_why_not: str = Field(description="reason why no step was simulated")


class SegmentsWanted(CloudWanted):
    """A draft in the segments of a plan."""

    plan: PlanName


class SegmentLoop(_Data):
    """A controller's speed loop in a segment: on the model, and the worst of the cars."""

    margins: MarginData
    worst: MarginData
    stable_share: float = Field(description="of the cars, the model among them")


class SegmentData(_Data):
    """A segment of driving torque with the loops that the plan's controller and the draft close."""

    segment: str
    speed_km_h: float
    friction: float = Field(description="of the road under the worse tyre; 1: dry")
    mass_kg: float | None = Field(description="of the vehicle; null: the model's")
    sliding: bool = Field(description="while the tyres slide; else while they grip")
    controller: str = Field(description="name of the file that the plan loads")
    own: SegmentLoop
    draft: SegmentLoop


class SegmentsData(_Data):
    """A plan's segments, and where the cars come from."""

    source: str
    cars: int
    segments: list[SegmentData]
    notes: list[str]


class DesignData(_Data):
    """A designed controller, evaluated on all plants within the model's uncertainty."""

    controller: str = Field(description="text of the controller file")
    margins: MarginData
    stable_share: float = Field(description="of the possible plants")
    worst_sensitivity_peak: float | None
    source: str = Field(description="where the possible plants come from")
    warnings: list[str]
    notes: list[str]


class PlanCopyWanted(_Data):
    """A copy of a plan with other controllers."""

    name: FileName
    controllers: dict[str, FileName] = Field(
        min_length=1, max_length=20, description="names of given controllers by the files that the plan loads"
    )
