"""What passes between the service and agents, which drive benches from other machines."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.api_schemas.api import (
    BenchName,
    ForecastData,
    Number,
    PersonName,
    Problem,
    PromptData,
    RunData,
    RunId,
)
from hil.core.errors import StopWay

AgentId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
#: A file that a run has left; what is hidden is not for others.
RunFileName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$")]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Text = Annotated[str, Field(max_length=2000)]
#: Of one line, printable.
Line = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")]
#: Of a file's content in one request.
MOST_PIECE_BYTES = 1_000_000
#: Of one file of a run.
MOST_FILE_BYTES = 16_000_000_000
MOST_FILES = 100

OrderKind = Literal["pause", "resume", "end", "answer", "emergency_stop", "reset", "forecast"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class TakenRun(_Data):
    """A run that was taken from the queue, with what its process needs to know.

    `plan_text` has its variables as chosen; `files`: content of what the plan loads, by name.
    """

    data: RunData
    plan_text: str
    plan_source: str
    confirmed_by: str
    accept_expired: str
    files: dict[str, str] = {}


class Taken(_Data):
    """Tasks of an agent."""

    run: TakenRun | None = Field(description="null if the queue of the bench is empty")


class PlanSent(_Data):
    """A plan with its variables as chosen; `files`: content of what lies beside it and is loaded, by name."""

    text: str
    source: str
    files: dict[str, str] = {}


class Order(_Data):
    """A request to an agent's bench; repeated until the agent has executed it."""

    id: str = Field(max_length=40)
    bench: BenchName
    kind: OrderKind
    run: RunId | None = Field(None, description="number of the run; null if it concerns the bench")
    by: str = ""
    origin: str = Field("", description="source address of an emergency stop")
    way: StopWay = Field("", description="and how")
    text: str = ""
    plan: PlanSent | None = Field(None, description="what is to be predicted")


class AgentBench(_Data):
    """A bench of an agent and its state."""

    name: BenchName
    title: Line
    simulated: bool
    limits: dict[Line, Number] = Field(max_length=200)
    units: dict[Line, Line] = Field(max_length=200)
    state: Literal["free", "running", "ending", "in_use", "emergency_stop"]
    why: Text = ""
    running: RunId | None = Field(None, description="also while its files are being uploaded")
    share: Annotated[Number, Field(ge=0, le=1)] | None = None
    doing: Text = ""
    message: Text = ""
    prompt: PromptData | None = None


class AgentReport(_Data):
    """Report of an agent, twice per second."""

    name: PersonName
    machine: PersonName
    version: Annotated[Line, Field(max_length=40)]
    benches: list[AgentBench] = Field(min_length=1, max_length=50)
    obeyed: list[Annotated[str, Field(max_length=40)]] = Field([], max_length=1000)
    leaving: bool = Field(False, description="true: the agent ends and its benches are no longer connected")


class AgentOrders(_Data):
    """Answer to a report of an agent."""

    orders: list[Order] = []
    waiting: list[BenchName] = Field([], description="free benches that have a queued run")
    refused: dict[str, str] = Field({}, description="benches that are not this agent's, with the reason")


class FileThere(_Data):
    """How much of a file the service has."""

    size: int


class FileMade(_Data):
    """A file of a run at its agent."""

    name: RunFileName
    size: int = Field(ge=0, le=MOST_FILE_BYTES)
    sha256: Sha256


class RunEnding(_Data):
    """How a run of an agent ended. `queued`: it did not start and is queued again."""

    state: Literal["ended", "interrupted", "queued"]
    exit_code: int | None = Field(None, ge=0, le=255)
    reason: Annotated[str, Field(max_length=20_000)] = ""
    dut: Line = ""
    ago_s: float = Field(0.0, ge=0, le=1e9, allow_inf_nan=False, description="when, before this is sent")
    files: list[FileMade] = Field([], max_length=MOST_FILES)


class Delivered(_Data):
    """Files that are missing or differ at the service; if none, the run is finished."""

    missing: list[str]


class AgentsForecast(_Data):
    """An agent's forecast of a plan, or the reason why there is none."""

    forecast: ForecastData | None = None
    problem: Problem | None = None
    refused: bool = Field(False, description="true: the plan is faulty; false: the agent failed")


class AgentData(_Data):
    """An agent."""

    name: str
    machine: str
    version: str
    benches: list[str]
    connected: bool
    heard_at: datetime.datetime = Field(description="time of its last report, to within half a minute")
