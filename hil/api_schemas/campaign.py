"""Campaigns: many simulations of a plan, as they pass over the API."""

from __future__ import annotations

import datetime
import hashlib
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.api_schemas.api import Record

#: `stopping`: what is under way is awaited and kept. A campaign whose service ended waits for the next one.
CampaignState = Literal["waiting", "running", "stopping", "ended", "failed", "cancelled"]
CAMPAIGN_OVER: tuple[CampaignState, ...] = ("ended", "failed", "cancelled")
#: A plan, a model or a controller that is sent with a campaign, by the name that the campaign has for it.
SentName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}\.(yaml|yml|toml)$")]
#: The table of a campaign that is over, as one file.
TABLE = "simulations.parquet"
#: What it came to, in numbers.
SUMMARY = "campaign.json"


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class CampaignWanted(_Data):
    """A campaign's file, and the files it needs that the service lacks."""

    text: str = Field(max_length=200_000, description="YAML as for `hil campaign`; file names without paths")
    files: dict[SentName, str] = Field({}, max_length=50, description="plan, model, controllers by name")

    @property
    def digest(self) -> str:
        """SHA-256, hexadecimal: the same of what says the same."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()


class CampaignExample(_Data):
    """A built-in campaign."""

    name: str
    title: str
    text: str


class PassedShare(_Data):
    """Number of simulations of a controller that passed so far."""

    controller: str = Field(description="name of its file; '' for the plan's own")
    passed: int
    of: int
    share: float | None = Field(description="null of none")
    interval: tuple[float, float] | None = Field(
        description="95 % confidence interval; null if no vehicles were sampled"
    )


class CampaignData(Record):
    """A campaign: queued, active or finished."""

    name: str
    title: str
    plan: str
    model: str
    state: CampaignState
    simulations: int = Field(description="number of simulations requested")
    done: int = Field(0, description="number of simulations on disk")
    rate_hz: float = Field(0.0, description="simulations per second, while it runs")
    draws: int = Field(description="vehicles sampled around each model; 0: values are given")
    controllers: list[PassedShare] = Field([])
    pass_share_wanted: float | None
    passed: bool | None = Field(None, description="true: each controller reaches the required pass rate")
    requested_by: str
    asked_at: datetime.datetime
    ended_at: datetime.datetime | None = None
    reason: str = Field("", description="reason of a failure")
    digest: str = Field(description="hash of the request; equal for equal content")
    files: list[str] = Field([], description="names of its files, when it is finished")


class Histogram(_Data):
    """How often a criterion had a value: `counts` in equal classes from `start`."""

    start: float
    width: float
    counts: list[int]


class CriterionFindings(_Data):
    """One criterion over the simulations of one controller."""

    id: str
    unit: str
    upper: float | None
    lower: float | None
    below: str = Field(description="segment whose value is the limit; '' if none")
    share: float | None = Field(description="of executed simulations that passed; null without a limit")
    median: float | None
    least: float | None
    largest: float | None
    histogram: Histogram | None = Field(description="null without values")
    rank_correlations: dict[str, float | None] = Field(
        description="Spearman's rank correlation with each input; null where there is none"
    )


class WorstSimulation(_Data):
    """A simulation with little margin, and what it had for inputs."""

    simulation: int
    draw: int
    margin: float
    binding: str = Field(description="the criterion with this margin")
    verdict: str
    inputs: dict[str, float]


class SimulationFiles(_Data):
    """A simulation of a campaign as files that a service takes: they name each other by these names."""

    name: str = Field(description="for bench file, plan, and controller if there is one")
    model_name: str
    plan: str = Field(description="text of the plan with the simulation's values and controller")
    model: str = Field(description="text of the car's model file")
    bench: str = Field(description="text of a simulated bench with this car")
    controller: str | None = Field(description="text of its file; null for what the plan itself loads")


class ControllerFindings(_Data):
    """What the simulations of one controller came to."""

    controller: str = Field(description="name of its file; '' for the plan's own")
    errors: int = Field(description="simulations that failed")
    criteria: list[CriterionFindings]
    worst: list[WorstSimulation]


class CampaignFindings(_Data):
    """What a finished campaign came to: distributions, what decides, worst cases."""

    inputs: dict[str, str] = Field(description="units by name of what differs between simulations")
    controllers: list[ControllerFindings]
    errors: dict[str, int] = Field(description="what went wrong, and how often")
