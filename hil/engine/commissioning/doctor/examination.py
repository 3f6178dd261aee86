"""What the doctor found: data, for people and programs."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from drivers import Finding
from hil.core.result import StreamClock, Zero

#: `fine`: no fault. `faults`: something is not as it should be. `not_there`: neither RMCU nor dynos answer.
Verdict = Literal["fine", "faults", "not_there"]


@dataclass
class BusFacts:
    """One bus as it was heard.

    Attributes:
        opened: whether it could be opened.
        load: share of the time in which frames were on the wire, stuff bits included; None if nothing was
            listened to.
        frames_s: frames a second.
        error_frames: that the adapter reported.
        unknown: identifiers that no device of the bench file sends or hears, with frames a second.
        controller: state and error counters of the adapter, as far as it tells them.
    """

    interface: str
    channel: str
    bit_rate: int
    opened: bool = False
    load: float | None = None
    frames_s: float | None = None
    error_frames: int = 0
    unknown: dict[str, float] = field(default_factory=dict)
    controller: dict[str, Any] = field(default_factory=dict)


@dataclass
class DeviceFacts:
    """One device: whether it answers, and what it says of itself. `answers` is None if it cannot be asked."""

    kind: str
    answers: bool | None = None
    facts: dict[str, str] = field(default_factory=dict)


@dataclass
class Examination:
    """A bench as it was found."""

    bench: str
    simulated: bool
    listened_s: float
    asked: bool = True
    buses: dict[str, BusFacts] = field(default_factory=dict)
    devices: dict[str, DeviceFacts] = field(default_factory=dict)
    clocks: list[StreamClock] = field(default_factory=list)
    zeros: list[Zero] = field(default_factory=list)
    calibration: dict[str, str] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)

    @property
    def verdict(self) -> Verdict:
        """What became of it."""
        if not any(self.devices[key].answers for key in ("rmcu", "dyno") if key in self.devices):
            return "not_there"
        return "faults" if any(finding.severity == "fault" for finding in self.findings) else "fine"

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        own = {**vars(self), "clocks": [clock.model_dump() for clock in self.clocks]}
        own["zeros"] = [zero.model_dump(exclude={"after", "drift_within"}) for zero in self.zeros]
        for name in ("buses", "devices"):
            own[name] = {key: asdict(value) for key, value in own[name].items()}
        own["findings"] = [asdict(finding) for finding in self.findings]
        return {"verdict": self.verdict, **own}
