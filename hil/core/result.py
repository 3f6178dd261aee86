"""The outcome of a run in the words of `result.json` (docs/reference/result.md)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.core.errors import StopWay
from hil.core.files.toml_file import FORMAT, FormatNumber

#: `done`: executed, and no criterion of the plan has a limit.
Verdict = Literal["pass", "fail", "error", "done"]
#: `informational`: no limit. `did_not_settle`: a failure if it has a limit, else counts as neither.
#: `not_judged`: its segment was not executed whole. `error`: could not be computed.
#: `undecided`: a comparison within its own scatter; it fails the run.
CriterionVerdict = Literal[
    "pass", "fail", "undecided", "informational", "did_not_settle", "not_judged", "error"
]
SafeState = Literal["confirmed", "not_confirmed", "not_needed"]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CriterionResult(_Frozen):
    """One criterion with its value; `reason` says why there is none."""

    id: str
    value: float | None
    unit: str
    upper: float | None = None
    lower: float | None = None
    below: str = Field("", description="segment whose value is the upper limit, if it is a relative one")
    verdict: CriterionVerdict
    title: str = ""
    definition: str = ""
    reason: str = ""
    source: Literal["plan", "device"] = Field("plan", description="source: the plan, or the device checks")

    @property
    def has_limit(self) -> bool:
        """Whether anything was demanded; a relative criterion demands even when its rival has no value."""
        return self.upper is not None or self.lower is not None or self.below != ""

    @property
    def failed(self) -> bool:
        """Beyond a limit, within its own scatter, or never settled where a limit asks for it."""
        if self.verdict == "did_not_settle":
            return self.has_limit
        return self.verdict in ("fail", "undecided")

    @property
    def margin(self) -> float | None:
        """Distance to the nearest limit as a share of that limit, positive inside.

        None without a value or a limit, and for a limit of zero.
        """
        if self.value is None:
            return None
        room = [(self.upper - self.value, self.upper)] if self.upper is not None else []
        room += [(self.value - self.lower, self.lower)] if self.lower is not None else []
        shares = [distance / abs(limit) for distance, limit in room if limit != 0]
        return min(shares) if shares else None


def verdict_of(criteria: Iterable[CriterionResult], *, stopped: bool, limit_tripped: str = "") -> Verdict:
    """A run's verdict: error when something stopped it or a criterion could not be judged, else fail or pass.

    A plan whose author gave no criterion a limit is done, and passed nothing.

    A limit of the bench that ended the run is a failure of the device where that was shown to be unstable.
    Criteria without a limit count as neither.
    """
    found = list(criteria)
    if limit_tripped and any(one.source == "device" and one.verdict == "fail" for one in found):
        return "fail"
    if stopped or any(criterion.verdict in ("error", "not_judged") for criterion in found):
        return "error"
    if any(criterion.failed for criterion in found):
        return "fail"
    judged = any(criterion.has_limit and criterion.source == "plan" for criterion in found)
    return "pass" if judged else "done"


class Segment(_Frozen):
    """A named stretch of the recording; times are on the recording's `time_s`.

    `end_s` is where it really ended: one that was stopped is not `complete`, and nothing is judged in it.
    """

    id: str
    kind: str = "step"
    start_s: float
    step_s: float
    end_s: float
    first_change_s: float | None = Field(
        None, description="when the torque first changes, where that is before the step; null: with the step"
    )
    complete: bool = True
    controller: str = ""
    controller_name: str = Field("", description="in the controller's file; '' in earlier recordings")
    initial_speed_km_h: float = 0.0
    load: Literal["vehicle", "speed"] = Field(
        "vehicle", description="load by the dynos: simulate the vehicle, or hold a speed"
    )
    reference_before: float = Field(0.0, description="value of the stepped quantity before the step")
    reference_after: float = Field(0.0, description="value of the stepped quantity after the step")
    quantity: Literal["", "motor_torque", "driving_torque"] = Field(
        "", description="requested quantity; '' in recordings of version 0.1"
    )
    torque_limit_nm: float | None = Field(None, description="of the controller; null: none drove the segment")
    gear_ratio: float | None = Field(
        None,
        description="motor speed over wheel speed, of the bench file, else of the last controller",
    )
    rolling_radius_m: float | None = Field(
        None,
        description="vehicle speed over wheel speed: the bench's wheel radius, less the slip it was set to",
    )
    friction: float | None = Field(
        None,
        description="least friction under a tyre, a share of a dry road's, as set; null: never set",
    )
    wheel_orders: tuple[float, ...] = Field(
        (), description="multiples of the wheel's revolutions that its bench file declares as excited"
    )

    @property
    def changes_from_s(self) -> float:
        """When the requested torque first changes: at the step, or at the first of several."""
        return self.step_s if self.first_change_s is None else self.first_change_s

    @property
    def slippery(self) -> bool:
        """Whether the road was set to less friction than a dry one has: wheels need not roll."""
        return self.friction is not None and self.friction < 1.0


class StreamClock(_Frozen):
    """How the samples of one stream lay in time; the first is the time base."""

    stream: str
    where: str
    counted_by: str
    offset_s: float = Field(description="how much later than the time base's sample of the same row it came")
    drift_ppm: float = Field(
        description="how much slower its clock is than the time base's; the base's: than the bench's"
    )
    latest_s: float = Field(description="by how much the latest frame came after its time")
    lost: int = Field(description="samples without a frame")
    left_out: int = Field(description="frames that cannot be assigned to a sample")


class Lateness(_Frozen):
    """How much later than meant, ms of the bench clock: median, 99th percentile and largest."""

    p50_ms: float
    p99_ms: float
    max_ms: float


class PeriodicRequests(_Frozen):
    """How well a request that devices expect again and again kept its time."""

    request: str
    device: str
    period_s: float
    count: int
    missed: int = Field(
        description="cycles in which none was sent: it came a cycle late or more, or not at all; also those "
        "in which the machine itself stood still"
    )
    sent: Lateness
    seen: Lateness | None = Field(None, description="on the bus; null where the adapter does not say")
    unseen: int = Field(
        0, description="requests that the adapter did not show on the bus, where it shows any"
    )

    @property
    def why_not_seen(self) -> str:
        """Why `seen` is null, in words; '' if it is not."""
        if self.seen is not None:
            return ""
        return "none came back from the bus" if self.unseen else "the adapter gives own frames not back"

    @property
    def missed_in_words(self) -> str:
        """How many cycles were missed, and that this says nothing of whose doing it was."""
        cycles = "1 cycle missed" if self.missed == 1 else f"{self.missed} cycles missed"
        return f"{cycles}, by the loop or while the machine stood still" if self.missed else cycles


class Timing(_Frozen):
    """How well the bench's own loop kept time; in virtual time it cannot but be exact, and has no entries."""

    clock: Literal["wall", "virtual"]
    requests: tuple[PeriodicRequests, ...] = ()
    pauses: int = Field(0, description="how often the loop stood still for longer than the bench allows for")
    longest_pause_s: float = 0.0


class Identity(_Frozen):
    """What a device says that it is; `expected` is what the bench file wants, '' if it does not say."""

    device: str
    name: str
    value: str = Field(description="'' if the device does not say")
    expected: str = ""

    @property
    def matches(self) -> bool:
        """Whether it is what the bench file wants, if it wants anything."""
        return self.expected in ("", self.value)


class Zero(_Frozen):
    """What a sensor read at rest, before the drives were enabled and after they were off again."""

    channel: str
    unit: str
    before: float | None = None
    after: float | None = None
    within: float | None = Field(
        None, description="largest magnitude before; null: the bench file states none"
    )
    drift_within: float | None = Field(None, description="largest change; null: none is stated")
    reason: str = Field("", description="reason of a missing value")

    @property
    def drift(self) -> float | None:
        """After less before; None if one is missing."""
        return None if self.before is None or self.after is None else self.after - self.before

    @property
    def offset_fits(self) -> bool:
        """Whether it reads what the bench file allows; what is not known does not."""
        return self.within is None or (self.before is not None and abs(self.before) <= self.within)

    @property
    def drift_fits(self) -> bool:
        """Whether it has changed by what the bench file allows; what is not known does not contradict."""
        return self.drift_within is None or self.drift is None or abs(self.drift) <= self.drift_within


class LimitResult(_Frozen):
    """A limit or an interlock of the bench file, and what was reached."""

    name: str
    channel: str
    of: Literal["value", "slope"] = "value"
    unit: str
    below: float | None = None
    above: float | None = None
    hysteresis: float = 0.0
    persistence_s: float | None = None
    persistence_samples: int | None = None
    response: str
    lowest: float | None = Field(None, description="null: nothing came, or a value was not known")
    highest: float | None = Field(None, description="null: nothing came, or a value was not known")
    reached: int = Field(0, description="number of times the response was triggered")


class Hold(_Frozen):
    """A time in which the run was held; on the recording's `time_s`."""

    start_s: float
    end_s: float
    cause: str
    ended_by: str = Field(description="operator, well again, or end of the run")


class StoppedInEmergency(_Frozen):
    """Who or what asked for an emergency stop, from where and how, and whether it was latched on disk."""

    by: str
    why: str
    latched: bool
    origin: str = Field("", description="source: address, terminal or device")
    way: StopWay = Field("", description="terminal, api, page, device or interlock")


class VariableValue(_Frozen):
    """A variable of the plan, as it was for this run."""

    name: str
    value: float
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.name} = {self.value:g} {self.unit}".rstrip()


class AcceptedExpiry(_Frozen):
    """Who let a run measure with sensors whose calibration had run out, and why; `sensors`: until when."""

    by: str
    reason: str
    sensors: dict[str, str]


class BusLoad(_Frozen):
    """Share of the time in which a bus was busy with frames, each with as many stuff bits as it can have."""

    bus: str
    bit_rate: int
    mean: float = Field(description="over the whole run")
    busiest: float = Field(description="in the busiest tenth of a second")


class RunResult(_Frozen):
    """What `result.json` holds."""

    @property
    def of_the_run(self) -> RunResult:
        """Without what is only known once the files are written."""
        return self.model_copy(update={"files": {}, "sha256": {}, "samples_sha256": ""})

    format: FormatNumber = FORMAT
    verdict: Verdict
    plan: str
    bench: str
    started_at: str = Field(
        "", description="when the recording begins: ISO 8601, UTC; '' of files that do not say it"
    )
    real_time_factor: float
    bench_time_s: float
    safe_state: SafeState
    variables: tuple[VariableValue, ...] = Field((), description="of the plan, as they were for this run")
    criteria: tuple[CriterionResult, ...] = ()
    segments: tuple[Segment, ...] = ()
    clocks: tuple[StreamClock, ...] = ()
    timing: Timing | None = None
    bus_loads: tuple[BusLoad, ...] = ()
    identities: tuple[Identity, ...] = ()
    zeros: tuple[Zero, ...] = ()
    limits: tuple[LimitResult, ...] = ()
    holds: tuple[Hold, ...] = ()
    emergency_stop: StoppedInEmergency | None = None
    end_steps: str = Field("", description="result of the plan's end steps, as read back")
    missing: tuple[str, ...] = Field(
        (), description="devices and parts that were not there and not needed; frames that came damaged"
    )
    not_checked: tuple[str, ...] = Field(
        (), description="device checks that were not made, with the reason, one sentence each"
    )
    accepted_expired: AcceptedExpiry | None = Field(
        None, description="person who accepted expired sensor calibrations"
    )
    files: dict[str, str] = {}
    sha256: dict[str, str] = Field({}, description="of each file that `files` names")
    samples_sha256: str = Field("", description="of the recording's samples, as its table `channels` has it")
    reason: str = ""
    limit_tripped: str = Field("", description="limit of the bench that ended the run; '' if none")
