"""What a view of a run shows, under way or over: channels, marks, traces of any stretch, spectra."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from hil.api_schemas.api import PredictedCriterion, RunId, _Data
from hil.api_schemas.comparison import ChannelName

Channels = Annotated[list[ChannelName], Field(min_length=1, max_length=24)]
Values = list[float | None]


class MarkData(_Data):
    """A segment, an event or a hold; times on the recording's clock."""

    kind: Literal["segment", "event", "hold"]
    name: str
    text: str = ""
    start_s: float
    step_s: float | None = Field(None, description="of a segment: its step")
    end_s: float | None = Field(None, description="null: a moment, or not ended yet")


class LimitLine(_Data):
    """A limit of a channel's value, in the channel's unit."""

    channel: str
    below: float | None = Field(None, description="reached below it")
    above: float | None = Field(None, description="reached above it")
    response: str = ""
    reached: int = 0


class EvidenceData(_Data):
    """What holds a run's files together."""

    samples_sha256: str = Field("", description="SHA-256 of the samples as they were recorded")
    files: dict[str, str] = Field({}, description="SHA-256 by file, as result.json has them")
    signed_by: str = Field("", description="who signed the report; '' if no one has")
    whole: bool = Field(True, description="false: the recording was cut off or damaged")


class RunViewData(_Data):
    """All of a run but its samples."""

    run: RunId
    live: bool
    first_s: float
    last_s: float
    sample_time_s: float | None
    channels: dict[str, str] = Field(description="unit by channel")
    marks: list[MarkData]
    limits: list[LimitLine]
    criteria: list[PredictedCriterion]
    facts: dict[str, str] = Field({}, description="of the run and the device, as recorded")
    evidence: EvidenceData | None = Field(None, description="null while the run is going on")


class TraceData(_Data):
    """A channel's lowest and highest value in each bucket; null where nothing was measured."""

    lowest: Values
    highest: Values


class RunTraces(_Data):
    """Traces of a stretch, in equal buckets; `exact`: each has one sample at most."""

    run: RunId
    start_s: float
    width_s: float
    exact: bool
    channels: dict[str, TraceData]


class RunSpectrum(_Data):
    """Power spectral density of a channel over a stretch, Hann window, without its trend."""

    run: RunId
    channel: str
    start_s: float
    end_s: float
    step_hz: float
    density: Values = Field(description="from 0 Hz on, in the channel's unit squared per Hz")
    band_energy: float = Field(description="8 to 20 Hz, in the channel's unit squared")


class LayoutData(_Data):
    """Plots as the page writes them in its addresses; '' for the usual ones."""

    text: str = Field("", max_length=2000, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")


class RunSamples(_Data):
    """Samples of channels at the same moments, for one over another; every `every`-th of the stretch."""

    run: RunId
    every: int
    time_s: Values
    channels: dict[str, Values]
