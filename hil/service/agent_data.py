"""What passes between the service and agents, which drive benches from other machines."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.core.errors import StopWay
from hil.service.data import BenchName, ForecastData, Number, PersonName, Problem, RunData, RunId

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
    """A run that was taken from the queue, with what its process is told.

    `plan_text` has its variables as chosen; `files`: content of what the plan loads, by name.
    """

    data: RunData
    plan_text: str
    plan_source: str
    confirmed_by: str
    accept_expired: str
    files: dict[str, str] = {}


class Taken(_Data):
    """What an agent is given to do."""

    run: TakenRun | None = Field(description="null if nothing waits for the bench")


class PlanSent(_Data):
    """A plan with its variables as chosen; `files`: content of what lies beside it and is loaded, by name."""

    text: str
    source: str
    files: dict[str, str] = {}


class Order(_Data):
    """What somebody asks of an agent's bench; told again and again until the agent has obeyed."""

    id: str = Field(max_length=40)
    bench: BenchName
    kind: OrderKind
    run: RunId | None = Field(None, description="of which run; null where it is about the bench")
    by: str = ""
    origin: str = Field("", description="of an emergency stop: from which address it came")
    way: StopWay = Field("", description="and how")
    text: str = ""
    plan: PlanSent | None = Field(None, description="what is to be predicted")


class AgentBench(_Data):
    """A bench of an agent: what it is, and what it does now."""

    name: BenchName
    title: Line
    simulated: bool
    limits: dict[Line, Number] = Field(max_length=200)
    units: dict[Line, Line] = Field(max_length=200)
    state: Literal["free", "running", "ending", "in_use", "emergency_stop"]
    why: Text = ""
    running: RunId | None = Field(None, description="also while its files are being delivered")
    share: Annotated[Number, Field(ge=0, le=1)] | None = None
    doing: Text = ""
    told: Text = ""


class AgentReport(_Data):
    """What an agent says of itself, twice a second."""

    name: PersonName
    machine: PersonName
    version: Annotated[Line, Field(max_length=40)]
    benches: list[AgentBench] = Field(min_length=1, max_length=50)
    obeyed: list[Annotated[str, Field(max_length=40)]] = Field([], max_length=1000)
    leaving: bool = Field(False, description="it ends: its benches are away from now on")


class AgentOrders(_Data):
    """What an agent has to do."""

    orders: list[Order] = []
    waiting: list[BenchName] = Field([], description="free benches for which a run waits")
    refused: dict[str, str] = Field({}, description="benches that are not this agent's, with the reason")


class FileThere(_Data):
    """How much of a file the service has."""

    size: int


class FileMade(_Data):
    """A file that a run has left at its agent."""

    name: RunFileName
    size: int = Field(ge=0, le=MOST_FILE_BYTES)
    sha256: Sha256


class RunEnding(_Data):
    """How a run of an agent ended. `queued`: nothing of it has happened, it waits again."""

    state: Literal["ended", "interrupted", "queued"]
    exit_code: int | None = Field(None, ge=0, le=255)
    reason: Annotated[str, Field(max_length=20_000)] = ""
    dut: Line = ""
    ago_s: float = Field(0.0, ge=0, le=1e9, allow_inf_nan=False, description="when, before this is sent")
    files: list[FileMade] = Field([], max_length=MOST_FILES)


class Delivered(_Data):
    """Files that the service has not, or has otherwise; without any, the run is over."""

    missing: list[str]


class AgentsForecast(_Data):
    """What an agent predicts of a plan, or why it cannot."""

    forecast: ForecastData | None = None
    problem: Problem | None = None
    refused: bool = Field(False, description="whether the plan is at fault, and not the agent")


class AgentData(_Data):
    """An agent, as it is known here."""

    name: str
    machine: str
    version: str
    benches: list[str]
    connected: bool
    heard_at: datetime.datetime = Field(description="when it was last heard of, to within half a minute")
