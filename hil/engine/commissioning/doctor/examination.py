"""What the doctor found, as data for people and programs: devices, calibration dates, emergency stops."""

from __future__ import annotations

import datetime
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from drivers import Finding
from hil.core.errors import BenchError
from hil.core.result import StreamClock, Zero
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.stop.emergency_stop import refuse_latched
from hil.engine.stop.stop_places import remark_on_place

_SOON = datetime.timedelta(days=30)


def findings_of_dates(file: BenchFile, today: datetime.date) -> Iterator[Finding]:
    """Calibrations that have run out, or soon will; and that none is stated."""
    where = f"{file.source}, [calibration]"
    for sensor, until in file.calibration.items():
        if until < today:
            fix = "have it calibrated and enter the new date; runs are refused until then"
            yield Finding("fault", f"the calibration of '{sensor}' expired on {until}", where, fix)
        elif until - today <= _SOON:
            what = f"the calibration of '{sensor}' expires in {(until - today).days} days, on {until}"
            yield Finding("hint", what, where, "have it calibrated before that day; later runs are refused")
    if not file.calibration and file.simulation is None:
        fix = "enter the last valid day of the calibration for each sensor"
        yield Finding("hint", "no calibration dates are stated", str(file.source), fix)


def findings_of_stops(file: BenchFile) -> Iterator[Finding]:
    """The one that a run is refused for; and where one would be kept, if others may not find it there."""
    try:
        refuse_latched(file)
    except BenchError as error:
        yield Finding("fault", error.what, error.where, error.fix)
    remark = remark_on_place(file)
    if remark:
        what, _, fix = remark.partition("; ")
        yield Finding("hint", what, f"bench '{file.name}'", fix)


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
