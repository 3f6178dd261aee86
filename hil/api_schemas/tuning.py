"""Tunings of controllers on a model and on a simulated bench, as they pass over the API."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.api_schemas.api import BenchName, Number, PlanName
from hil.api_schemas.design import FileName
from hil.api_schemas.study import StudyData

Kept = Literal["response_time", "steady_error", "torque_effort", "stability", "criteria"]
PersonName = Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class TuningWanted(_Data):
    """A tuning on a model, as `hil tune`."""

    plan: PlanName
    model: FileName
    bench: BenchName
    controller: str = Field("", max_length=100, description="the plan's name of what is tuned; '': the last")
    draws: int = Field(0, ge=0, le=500, description="cars around the model")
    starts: int = Field(6, ge=0, le=50, description="further starting points of the search")
    at_most_min: float = Field(10.0, gt=0, le=120, allow_inf_nan=False)
    may_worsen: list[Kept] = Field([], max_length=5, description="what may get worse than with the start")
    seed: int = Field(0, ge=0, le=2**31 - 1)


class AutotuningPlanned(_Data):
    """A sequence on a simulated bench, as `hil autotune`, before somebody consents to it."""

    plan: PlanName = Field(description="acceptance plan whose worst margin is maximised")
    identify: PlanName = "short_identification"
    model: FileName
    bench: BenchName
    controller: str = Field("", max_length=100, description="the plan's name of what is tuned; '': the last")
    rounds: int = Field(3, ge=1, le=10)
    runs: int = Field(6, ge=1, le=20, description="on the bench, in a round")
    draws: int = Field(0, ge=0, le=500)
    diagnose_min: float = Field(15.0, gt=0, le=120, allow_inf_nan=False)


class EnvelopeData(_Data):
    """What a sequence may ask of its bench: predicted, to be consented to."""

    bench: str
    largest: dict[str, float] = Field(description="largest magnitude by channel")
    units: dict[str, str]
    runs: int
    bench_time_s: float
    words: str


class AutotuningWanted(AutotuningPlanned):
    """A sequence with the envelope that a person consents to."""

    largest: dict[str, Number] = Field(max_length=50, description="by channel, as in the envelope shown")
    bench_time_s: Number = Field(gt=0)
    confirm: PersonName = Field(description="name of the person who consents")


class ProgressData(_Data):
    """What a tuning does now, and what it has reported."""

    text: str = ""
    share: float = 0.0
    lines: list[str] = []


class TunedPoint(_Data):
    """A controller within the hard limits that no other beats in every figure."""

    values: dict[str, float]
    figures: list[float | None]


class TunedParameter(_Data):
    """A free number of the controller."""

    value: float
    start: float
    lower: float
    upper: float


class TuningData(_Data):
    """A tuning: progress while it runs, the front and what was chosen afterwards."""

    study: StudyData
    progress: ProgressData
    worst_margin: float | None = None
    start_worst_margin: float | None = None
    ended: str = ""
    figures: list[str] = Field([], description="names of the front's figures")
    front: list[TunedPoint] = []
    parameters: dict[str, TunedParameter] = {}
    worse: list[str] = Field([], description="what is worse than with the start, in words")


class DecisionData(_Data):
    """A decision of a sequence, with its reason."""

    round: int
    stage: str
    found: str
    decided: str
    why: str


class AutotuningData(_Data):
    """A sequence: every decision as it falls, and what it came to."""

    study: StudyData
    progress: ProgressData
    consent: str = ""
    envelope: dict[str, Any] = {}
    decisions: list[DecisionData] = []
    ended: str = ""
    worst_margin: dict[str, float | None] = {}
    values: dict[str, float] = Field({}, description="free numbers of the best controller")
