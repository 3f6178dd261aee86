"""Identifications and diagnoses of runs and given recordings, as they pass over the API."""

from __future__ import annotations

import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from hil.api_schemas.api import Record, RunId
from hil.api_schemas.design import FileName, Numbers

StudyKind = Literal["identification", "diagnosis", "tuning", "autotuning"]
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
    """An identification, a diagnosis or a tuning: queued, active or finished."""

    kind: StudyKind
    state: StudyState
    runs: list[int]
    recordings: list[int] = Field([], description="given recordings")
    model: str = Field("", description="model of a diagnosis or a tuning")
    plan: str = Field("", description="plan of a tuning")
    bench: str = Field("", description="bench of a tuning")
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
    fit_gain_lower_db: Numbers = Field(description="95 % interval of the fit itself; null if none is known")
    fit_gain_upper_db: Numbers
    fit_phase_lower_deg: Numbers
    fit_phase_upper_deg: Numbers


class FittedParameter(_Data):
    """A parameter with its 95 % interval; null if the fit has none."""

    name: str
    unit: str
    value: float
    lower: float | None
    upper: float | None


class FittedMisfit(_Data):
    """Root mean square over frequency of measured minus fitted, noise included."""

    gain_db: float | None
    phase_deg: float | None


class FittedResponse(_Data):
    """A fit's response of one output."""

    channel: str
    gain_db: Numbers
    phase_deg: Numbers


class FittedResonance(_Data):
    """An oscillating pole pair with its standard errors; null if they do not hold."""

    frequency_hz: float | None
    damping: float | None
    frequency_error_hz: float | None
    damping_error: float | None


class FittedOrder(_Data):
    """An order that was tried, and the evidence for it."""

    order: int
    integrator: bool = Field(description="whether a pole lies at the origin")
    chosen: bool
    held_out: float = Field(description="mean squared error on data left out, in noise variances")
    relative_excess: float = Field(description="rms error on data left out beyond noise, of the response")
    chi_square: float | None = Field(description="weighted residual per degree of freedom; 1 is noise")
    bic: float | None = Field(description="Bayesian information criterion; differences count")
    parameters: int | None = Field(description="number of fitted parameters")
    dead_time_s: float
    dead_time_error_s: float | None = Field(description="standard error; null if it does not hold")
    resonances: list[FittedResonance]
    verdict: str = Field(description="linear, doubtful, or '' if not known")
    model: str = Field(description="name of its file; '' without one")
    misfit: dict[str, FittedMisfit] = Field(description="by output")
    responses: list[FittedResponse]


class FittedChain(_Data):
    """A driveline chain that was fitted."""

    kind: str
    chosen: bool
    explains: bool = Field(description="whether every output is explained")
    model: str = Field(description="name of its file; '' without one")
    misfit: dict[str, FittedMisfit] = Field(description="by output")
    parameters: list[FittedParameter]


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
    orders: list[FittedOrder]
    chains: list[FittedChain]


class FoundEffect(_Data):
    """An effect that the recordings show and the model lacks."""

    id: str
    parameters: dict[str, float | str]
    standard_error: dict[str, float]
    confidence: float
    channels: list[str]
    band_hz: tuple[float, float]
    condition: str
    one_of: str = Field("", description="names that the data cannot tell apart; they share the confidence")


class FoundAlternative(_Data):
    """An alternative effect for the same gap; `plan` is the file of the test that distinguishes them."""

    id: str
    confidence: float
    separating_test: str
    plan: str | None = None
    one_of: str = Field("", description="names that the data cannot tell apart; they share the confidence")


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
