"""What passes over the API, both ways. Names, units and states: docs/reference/api.md."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

#: Largest number that every database and every JavaScript takes as it is.
_LARGEST_ID = 2**31 - 1

RunId = Annotated[int, Field(ge=1, le=_LARGEST_ID)]
BenchName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$")]
PlanName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$")]
#: A person's or a program's name as it stands in reports: printable, on one line.
PersonName = Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[^\x00-\x1f\x7f-\x9f]+$")]
Number = Annotated[float, Field(allow_inf_nan=False)]

#: `waiting_approval`: hazardous, and no one has approved it. `interrupted`: the service ended meanwhile.
RunState = Literal["waiting_approval", "queued", "running", "ended", "interrupted", "cancelled"]
RunVerdict = Literal["pass", "fail", "error", "done"]
OVER: tuple[RunState, ...] = ("ended", "interrupted", "cancelled")

#: `away`: its agent is not heard of.
BenchState = Literal["free", "running", "ending", "in_use", "emergency_stop", "away"]
Role = Literal["viewer", "operator", "engineer", "admin", "agent"]
#: Of people, each may what those before it may.
LADDER: tuple[Role, ...] = ("viewer", "operator", "engineer", "admin")
#: An agent may do an agent's work, and nothing else.
ROLES: tuple[Role, ...] = (*LADDER, "agent")


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Record(_Data):
    """What is known of something by its number."""

    id: RunId
    place: str = Field("", description="service that owns it, if it is not the one queried")


class Problem(_Data):
    """An error: what, where, and what to do."""

    what: str
    where: str = ""
    fix: str = ""


class Health(_Data):
    """State of the service."""

    status: Literal["ok"]
    version: str
    up_s: float = Field(description="seconds since the service started")
    runs_not_stored: int = Field(
        0, description="runs with files that are not in the store; 0 without a store"
    )
    results_not_stored: int = Field(
        0, description="finished studies, campaigns and given recordings with files that are not in the store"
    )
    store_problem: str = Field("", description="why files do not reach the store; '' if they do")
    stop_url: str = Field(
        "",
        description="address of the stop post, which is independent of the service; '' if not available",
    )
    sign_in: str = Field(
        "", description="name of the provider where people sign in by OpenID Connect; '' for tokens only"
    )
    audit_problem: str = Field("", description="fault of the audit log; '' if it is unchanged")
    kept_apart: int = Field(0, description="files of an earlier version's folder that are not shared")


class RunWanted(_Data):
    """A run to queue."""

    plan: PlanName
    bench: BenchName
    values: dict[str, Number] = Field({}, max_length=100, description="variables of the plan by name")
    priority: int = Field(0, ge=-100, le=100, description="higher ones first; equal ones in order of arrival")
    confirmed_by: str = Field(
        "",
        max_length=100,
        pattern=r"^[^\x00-\x1f\x7f-\x9f]*$",
        description="name of the person who confirms all prompts",
    )
    accept_expired: str = Field(
        "",
        max_length=500,
        pattern=r"^[^\x00-\x1f\x7f-\x9f]*$",
        description="'NAME: reason' of the person who accepts expired sensor calibrations",
    )
    key: str = Field(
        "",
        max_length=100,
        pattern=r"^[A-Za-z0-9_.:-]*$",
        description="a repeated request with the same key queues no second run",
    )


class ReservationData(_Data):
    """A bench that somebody has for themselves from a moment to another."""

    id: RunId
    bench: str
    who: str
    begins: datetime.datetime
    ends: datetime.datetime
    reason: str
    admitted: list[RunId] = Field([], description="runs of others that may start meanwhile")


class PromptData(_Data):
    """A question of a run to its operator."""

    text: str
    answer_by: datetime.datetime = Field(description="without an answer by then the run ends")
    picture: str = Field("", description="name of a picture of the service; '' for none")


class RunData(_Data):
    """A run: queued, active or finished."""

    id: RunId
    plan: str
    title: str
    bench: str
    state: RunState
    values: dict[str, float]
    priority: int
    hazard: str = Field("", description="why its plan is hazardous; '' if it is not")
    requested_by: str
    approved_by: str = ""
    queued_at: datetime.datetime
    started_at: datetime.datetime | None = None
    ended_at: datetime.datetime | None = None
    share: float | None = Field(None, description="progress, 0 to 1, while it is running")
    doing: str = Field("", description="present activity, while it is running")
    message: str = Field("", description="last message to the operator, while it is running")
    prompt: PromptData | None = Field(None, description="question that waits for an answer")
    exit_code: int | None = Field(None, description="exit code, as of `hil run`")
    verdict: RunVerdict | None = None
    safe_state: Literal["confirmed", "not_confirmed", "not_needed"] | None = None
    reason: str = Field("", description="reason of its end, or of waiting")
    dut: str = Field("", description="serial number or name of the tested device, when it is finished")
    files: list[str] = Field([], description="names of its files, when it is finished")
    expected_start: datetime.datetime | None = Field(
        None, description="when it is expected to start, while it is queued; null: not known"
    )
    expected_end: datetime.datetime | None = Field(
        None, description="when it is expected to end, while it is queued or running; null: not known"
    )
    waits_for: ReservationData | None = Field(
        None, description="reservation of another person that it waits for, while it is queued"
    )


class RunChange(_Data):
    """Change of a queued run."""

    priority: int = Field(ge=-100, le=100)


class Answer(_Data):
    """A line for the operator's prompt of a run."""

    text: str = Field("", max_length=500, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")


class LastSpeed(_Data):
    """The motor's speed as it was measured last."""

    speed_rad_s: float
    at: datetime.datetime
    turns: bool = Field(description="whether that is more than standstill")


class BenchData(_Data):
    """A bench and its state."""

    name: str
    title: str
    simulated: bool
    state: BenchState
    why: str = Field("", description="user of the bench, or the reason why it is blocked")
    running: RunId | None = None
    waiting: int = Field(description="runs in its queue")
    limits: dict[str, float] = Field(description="largest magnitude by channel, in the channel's unit")
    units: dict[str, str] = Field(description="unit by channel, of all that is recorded")
    lease: str = Field("", description="user who has it for a while from now on")
    lease_until: datetime.datetime | None = Field(None, description="when that ends")
    reserved_by: str = Field("", description="user whose reservation is under way")
    reserved_until: datetime.datetime | None = Field(None, description="when that reservation ends")
    machine: str = Field("", description="machine of its agent; '' for a bench of the service")
    stop_confirmed: bool = Field(True, description="false while an agent has not confirmed an emergency stop")
    away_since: datetime.datetime | None = Field(None, description="time of the last report of its agent")
    last_speed: LastSpeed | None = Field(
        None, description="of its newest run, while an emergency stop is latched; null if it is not known"
    )
    speed_unknown: str = Field("", description="why it is not known, where that was looked for")


class VariableData(_Data):
    """A variable of a plan."""

    default: float
    unit: str = ""
    lower: float | None = None
    upper: float | None = None
    description: str = ""


class PlanData(_Data):
    """A plan that can be queued."""

    name: str
    title: str
    description: str
    hazard: str = ""
    built_in: bool
    variables: dict[str, VariableData]
    duration_s: float | None = Field(
        None, description="bench time with the default values, estimated without a bench"
    )
    largest_requests_nm: dict[str, float] = Field(
        {}, description="largest magnitude of each requested torque; `driving_torque` is at the wheels"
    )


class ForecastWanted(_Data):
    """Input of a forecast."""

    plan: PlanName
    bench: BenchName
    values: dict[str, Number] = Field({}, max_length=100)
    text: str | None = Field(
        None, max_length=200_000, description="YAML in place of that of the plan, as it is written; engineers"
    )


class PredictedPeak(_Data):
    """Largest magnitude of a channel, and the bench's limit, in the channel's unit."""

    value: float
    limit: float


class PredictedCriterion(_Data):
    """A predicted criterion."""

    id: str
    value: float | None
    unit: str
    upper: float | None = None
    lower: float | None = None
    below: str = Field("", description="segment whose value is the limit")
    verdict: str
    margin: float | None = None
    title: str = ""
    reason: str = ""
    source: str = Field("plan", description="plan, or device: requirements on any device")


class LoopData(_Data):
    """Margins of the speed loop that a controller closes on the bench's model; null: no crossing."""

    stable: bool
    gain_margin_db: float | None
    phase_margin_deg: float | None
    delay_margin_s: float | None
    sensitivity_peak: float | None
    sensitivity_peak_hz: float | None


class ForecastData(_Data):
    """Duration, peaks and criteria of a plan on a bench, as predicted."""

    fits: bool
    duration_s: float
    predicted: dict[str, PredictedPeak]
    criteria: list[PredictedCriterion]
    bus_loads: dict[str, float] = Field({}, description="highest bus load in a millisecond, by bus")
    largest_requests_nm: dict[str, float] = Field(
        {}, description="largest magnitude of each requested torque, with these values of the variables"
    )
    loops: dict[str, LoopData] = Field({}, description="by controller of the plan")


class TrendPoint(_Data):
    """A criterion in one run; its limits as they were."""

    run: RunId
    ended_at: datetime.datetime
    dut: str = Field(description="serial number or name of the tested device")
    value: float | None
    unit: str
    upper: float | None = None
    lower: float | None = None
    verdict: str


class TrendSignal(_Data):
    """A rule of control charts that values of a trend broke."""

    rule: str = Field(description="as Nelson (1984) numbers them: `nelson_1`, …")
    text: str
    runs: list[RunId] = Field(description="the runs whose values broke it")
    present: bool = Field(description="true: the newest value is among them")


class TrendData(_Data):
    """Trend of a criterion over runs, oldest first; the limits are those of the newest run."""

    criterion: str
    unit: str
    upper: float | None = None
    lower: float | None = None
    points: list[TrendPoint]
    mean: float | None = None
    deviation: float | None = Field(
        None, description="standard deviation from the moving range; null for less than 5 values"
    )
    cpk: float | None = Field(None, description="distance of the mean to the nearer limit, in 3 deviations")
    count: int = Field(0, description="number of values")
    cpk_lower: float | None = Field(None, description="lower end of Cpk's 95 % interval")
    cpk_upper: float | None = Field(None, description="upper end of Cpk's 95 % interval")
    signals: list[TrendSignal] = Field([], description="of 5 values or more")


class Me(_Data):
    """The present user and role."""

    name: str
    role: Role
    tokens: bool = Field(description="true: this service requires tokens")


class TokenWanted(_Data):
    """A token to make."""

    name: PersonName
    role: Role
    for_days: float = Field(365.0, gt=0, le=3650, description="validity, days")


class TokenData(_Data):
    """A token, without its secret."""

    id: RunId
    name: str
    role: Role
    made_at: datetime.datetime
    expires_at: datetime.datetime | None = Field(None, description="null: valid until it is revoked")
    revoked_at: datetime.datetime | None = None


class TokenMade(_Data):
    """A new token; its secret is given only once."""

    token: TokenData
    secret: str


class Login(_Data):
    """A token for the page."""

    secret: str = Field(min_length=1, max_length=200, pattern=r"^[\x21-\x7e]+$")


class AuditEntry(_Data):
    """An entry of the audit log."""

    id: int
    at: datetime.datetime
    who: str
    role: str
    action: str
    target: str
    detail: str


class LeaseWanted(_Data):
    """A reservation of a bench; repeat the request to extend it."""

    for_s: float = Field(60.0, ge=1, le=3600, allow_inf_nan=False)


class LeaseData(_Data):
    """Holder of a reserved bench, and the end of the reservation."""

    bench: str
    holder: str
    until: datetime.datetime
