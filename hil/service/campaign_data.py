"""Campaigns: many simulations of a plan, as they pass over the API."""

from __future__ import annotations

import datetime
import hashlib
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.service.data import Record

#: `stopping`: what is under way is awaited and kept. A campaign whose service ended waits for the next one.
CampaignState = Literal["waiting", "running", "stopping", "ended", "failed", "cancelled"]
CAMPAIGN_OVER: tuple[CampaignState, ...] = ("ended", "failed", "cancelled")
#: A plan, a model or a controller that is sent with a campaign, by the name that the campaign has for it.
SentName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}\.(yaml|yml|toml)$")]
#: The table of a campaign that is over, as one file.
TABLE = "simulations.parquet"


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class CampaignWanted(_Data):
    """A campaign's file, and those beside it that the service has not."""

    text: str = Field(
        max_length=200_000, description="YAML as of `hil campaign`; it names files without paths"
    )
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
    """How many simulations of a controller passed so far."""

    controller: str = Field(description="its file's name; '' for the plan's own")
    passed: int
    of: int
    share: float | None = Field(description="null of none")
    interval: tuple[float, float] | None = Field(
        description="holds the true share with 95 %; null where values were chosen and no cars drawn"
    )


class CampaignData(Record):
    """A campaign: wanted, under way, or over."""

    name: str
    title: str
    plan: str
    model: str
    state: CampaignState
    simulations: int = Field(description="how many are wanted")
    done: int = Field(0, description="how many are on disk")
    rate_hz: float = Field(0.0, description="how many a second, while it runs")
    draws: int = Field(description="cars drawn around each model; 0: values are chosen")
    controllers: list[PassedShare] = Field([])
    pass_share_wanted: float | None
    passed: bool | None = Field(None, description="whether each controller passes as often as is wanted")
    requested_by: str
    asked_at: datetime.datetime
    ended_at: datetime.datetime | None = None
    reason: str = Field("", description="why it did not end as it should")
    digest: str = Field(description="of what was asked: the same of what says the same")
    files: list[str] = Field([], description="names of its files, once it is over")
