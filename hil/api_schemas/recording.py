"""Recordings that people give to a service, as they pass over the API."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import Field

from hil.api_schemas.agent import MOST_FILE_BYTES, Sha256
from hil.api_schemas.api import Record, _Data

#: `arriving`: pieces are missing; `checking`: it is compared with its SHA-256 and read; `refused`: `reason`
#: says why.
RecordingState = Literal["arriving", "checking", "ready", "refused"]
RecordingName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$")]
#: One of `--columns`; files of the service's machine are not read for it.
Column = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,99} ?=[^\x00-\x1f\x7f-\x9f]*$", max_length=500)]
Columns = Annotated[list[Column], Field(max_length=100)]
MOST_SHOWN_CHANNELS = 1000


class RecordingWanted(_Data):
    """A recording whose pieces are sent next."""

    name: RecordingName = Field(description="file name; its ending tells the kind")
    size: int = Field(ge=1, le=MOST_FILE_BYTES, description="bytes")
    columns: Columns = Field([], description="which column is which channel, as `--columns 'CHANNEL=COLUMN'`")


class RecordingColumns(_Data):
    """Which column of another tool's file is which channel."""

    columns: Columns


class RecordingWhole(_Data):
    """What a recording is when all of its pieces are there."""

    sha256: Sha256


class RecordedChannel(_Data):
    """A channel of a recording."""

    name: str
    unit: str


class RecordingData(Record):
    """A recording that somebody gives or has given."""

    name: str
    size: int = Field(description="bytes")
    received: int = Field(description="bytes of it that are here")
    state: RecordingState
    columns: list[str]
    sha256: str = Field("", description="'' until all pieces are there")
    given_by: str
    given_at: datetime.datetime
    reason: str = Field("", description="why it is refused, and what to do")
    samples: int | None = None
    duration_s: float | None = None
    channel_count: int = 0
    channels: list[RecordedChannel] = Field([], description="the first thousand; none in lists")
    plan: str = Field("", description="plan of the run that it is a recording of; '' of other tools' files")
    notes: list[str] = Field([], description="what reading assumed, mended or found damaged; none in lists")
    used: str = Field("", description="file that studies read")
    files: list[str] = Field([])


class RecordingCurve(_Data):
    """A channel in equal buckets; `gap` is the rms of the difference from the recording over its own rms."""

    channel: str
    unit: str
    lowest: list[float | None]
    highest: list[float | None]
    gap: float | None = Field(None, description="of a simulated channel; null of a recorded one")


class RecordingCurves(_Data):
    """Channels of a recording, or of a model that was driven by it, so that no peak is lost."""

    start_s: float
    width_s: float
    curves: list[RecordingCurve]
    notes: list[str]
