"""Identifications and diagnoses of runs and given recordings, as they pass over the API."""

from __future__ import annotations

import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from hil.api_schemas.api import Record, RunId
from hil.api_schemas.design import FileName, Numbers

StudyKind = Literal["identification", "diagnosis"]
StudyState = Literal["waiting", "running", "ended", "failed", "cancelled", "interrupted"]
STUDY_OVER: tuple[StudyState, ...] = ("ended", "failed", "cancelled", "interrupted")
#: Of runs, or of recordings that were given.
Chosen = Annotated[list[RunId], Field(max_length=20)]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class _OfRecordings(_Data):
    runs: Chosen = []
    recordings: Chosen = Field([], description="numbers of given recordings")

    @model_validator(mode="after")
    def _something(self) -> Self:
        if not self.runs and not self.recordings:
            raise ValueError("choose at least one run or recording")
        return self


class IdentificationWanted(_OfRecordings):
    """Identification of a model from runs or given recordings with chirps or multisines."""


class DiagnosisWanted(_OfRecordings):
    """Diagnosis of the difference between a model and runs or given recordings."""

    model: FileName
    holdout: Chosen = Field([], description="runs for validation, not used in the fit")
    holdout_recordings: Chosen = Field([], description="given recordings for validation")
    at_most_min: float = Field(10.0, gt=0, le=60, allow_inf_nan=False)


class StudyData(Record):
    """An identification or a diagnosis: queued, active or finished."""

    kind: StudyKind
    state: StudyState
    runs: list[int]
    recordings: list[int] = Field([], description="given recordings")
    model: str = Field("", description="model of a diagnosis")
    requested_by: str
    asked_at: datetime.datetime
    ended_at: datetime.datetime | None = None
    reason: str = Field("", description="reason of a failure")
    files: list[str] = Field([], description="names of its files, when it is finished")


class FittedOutput(_Data):
    """A measured frequency response and the fit's: gain in dB, phase in degrees."""

    channel: str
    gain_db: Numbers
    gain_lower_db: Numbers = Field(description="95 % interval; null where it has no end")
    gain_upper_db: Numbers
    phase_deg: Numbers
    phase_lower_deg: Numbers = Field(description="95 % interval")
    phase_upper_deg: Numbers
    coherence: Numbers
    fit_gain_db: Numbers
    fit_phase_deg: Numbers


class FittedParameter(_Data):
    """A parameter with its 95 % interval; null if the fit has none."""

    name: str
    unit: str
    value: float
    lower: float | None
    upper: float | None


class IdentificationData(_Data):
    """Result of an identification."""

    study: StudyData
    verdict: str
    warnings: list[str]
    resonance_hz: float | None
    chain: str | None = Field(description="the driveline that explains the response; null if none does")
    frequency_hz: Numbers
    outputs: list[FittedOutput]
    parameters: list[FittedParameter]


class FoundEffect(_Data):
    """An effect that the recordings show and the model lacks."""

    id: str
    parameters: dict[str, float | str]
    standard_error: dict[str, float]
    confidence: float
    channels: list[str]
    band_hz: tuple[float, float]
    condition: str


class FoundAlternative(_Data):
    """An alternative effect for the same gap; `plan` is the file of the test that distinguishes them."""

    id: str
    confidence: float
    separating_test: str
    plan: str | None = None


class FoundGap(_Data):
    """A channel's gap before and after, and its noise, over the rms of what was measured."""

    before: float
    after: float
    noise_floor: float


class FoundMap(_Data):
    """Error / noise for each recording, channel and band; 1: noise only, null: no value."""

    recordings: list[str]
    channels: list[str]
    bands_hz: list[tuple[float, float]]
    before: list[list[Numbers]]
    after: list[list[Numbers]]


class DiagnosisData(_Data):
    """Result of a diagnosis."""

    study: StudyData
    verdict: str
    unfinished: str
    effects: list[FoundEffect]
    alternatives: list[FoundAlternative]
    gap: dict[str, FoundGap]
    holdout_gap: dict[str, FoundGap]
    map: FoundMap
    remaining_gap: str
    parameter_updates: dict[str, dict[str, Any]]
    notes: list[str]
