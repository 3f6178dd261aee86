"""Two runs side by side, as they pass over the API; differences are listed from the first to the other."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.api_schemas.api import RunData
from hil.core.result import CriterionVerdict

ChannelName = Annotated[str, Field(min_length=1, max_length=100)]
SegmentName = Annotated[str, Field(min_length=1, max_length=200)]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class InputDifference(_Data):
    """An input that differs between the two runs; `–` if one has no value.

    Values of plans are named by segment and kind, or by criterion: `segment tip_in (step): to_nm`.
    """

    kind: Literal["controller", "model", "bench", "plan"]
    name: str
    first: str
    other: str
    unit: str = Field("", description="unit of both; '' if the input says none")


class ComparedCriterion(_Data):
    """A criterion of either run, in its unit; `relative` is (other - first) / |first|.

    A run that has no such criterion has null as value and as verdict.
    """

    id: str
    title: str
    unit: str
    limit: str
    values: tuple[float | None, float | None]
    verdicts: tuple[CriterionVerdict | None, CriterionVerdict | None]
    relative: float | None
    better: Literal["lower", "higher", ""] = Field(
        "", description="side on which its limits let it lie; '' for limits on both, none, or different ones"
    )
    source: Literal["plan", "device"] = Field("plan", description="source: the plan, or the device checks")


class ComparedResponse(_Data):
    """A channel of a segment: rms of the difference over the first run's rms around its mean."""

    segment: str
    channel: str
    gap: float | None


class ComparedSegment(_Data):
    """A segment of both runs, over the time from its step; `channels` are those of both recordings."""

    id: str
    kind: str
    start_s: float
    end_s: float
    channels: list[str]


class ComparisonData(_Data):
    """Two runs side by side; `plan` is that of the first."""

    first: RunData
    other: RunData
    plan: str
    verdicts: tuple[str, str]
    distance: float | None = Field(description="mean magnitude of the relative differences of the criteria")
    differences: list[InputDifference]
    plan_summary: list[InputDifference] = Field(
        description="of the differences the first by which the other's plan does or demands something else"
    )
    plan_more: int = Field(description="how many more such differences there are")
    notes: list[str]
    criteria: list[ComparedCriterion]
    responses: list[ComparedResponse]
    segments: list[ComparedSegment]


class BestRunData(_Data):
    """The run to compare with: of those that passed the same criteria, the one farthest from its limits.

    That is the one whose smallest margin is largest. A margin is the distance from the value to the nearer
    limit over the magnitude of that limit. A run of the same plan
    with the same values comes before others, and of these one of the same bench.
    """

    run: RunData | None = Field(description="null: no run has passed the criteria of this run")
    margin: float | None = Field(None, description="its smallest margin, over the criteria of its plan")
    criterion: str = Field("", description="the criterion of that margin")
    other_values: dict[str, float] = Field(
        {}, description="values of its plan's variables that are not those of this run"
    )
    among: int = Field(description="of how many runs that passed, and are as near, it is the best")


class Envelope(_Data):
    """Lowest and highest value by bucket; null without data."""

    lowest: list[float | None]
    highest: list[float | None]


class TracesData(_Data):
    """A channel of both runs over the time from their own steps, in buckets that lose no peak."""

    segment: str
    channel: str
    unit: str
    start_s: float
    width_s: float
    runs: tuple[Envelope, Envelope]
