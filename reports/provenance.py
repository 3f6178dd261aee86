"""Where a recording comes from: bench, device, versions, calibration, and whether its files are intact."""

from __future__ import annotations

import datetime
import hashlib
import math
from dataclasses import dataclass
from typing import Any

from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.files import sha256_of
from hil.core.files.toml_file import parse_toml
from hil.core.recording import VEHICLE, Recording
from hil.core.result import Lateness, PeriodicRequests, RunResult
from reports import labels

_CONTROLLER = "controller/"
_NOT_SHOWN = ("plant", "meta")


@dataclass(frozen=True)
class Fact:
    """A name with its value; `state` is '', 'good' or 'bad'."""

    name: str
    value: str
    state: str = ""


@dataclass(frozen=True)
class StoredFile:
    """An attachment with the hash it has now and what became of the hash it was stored with."""

    name: str
    size: str
    sha256: str
    check: str
    state: str


@dataclass(frozen=True)
class ControllerTable:
    """Parameters (rows) of the controllers (columns) as they were loaded."""

    names: tuple[str, ...]
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def table(recording: Recording, name: str) -> tuple[Fact, ...]:
    """A metadata table as facts, in its own order."""
    return tuple(Fact(key, value) for key, value in recording.metadata.get(name, {}).items())


def dut_facts(recording: Recording) -> tuple[Fact, ...]:
    """The device under test as the bench file describes it: 'gear_ratio' becomes 'Gear ratio'."""
    return tuple(Fact(_words(fact.name), fact.value) for fact in table(recording, "dut"))


_LABORATORY = {
    "laboratory": "Laboratory",
    "report_number": "Report number",
    "customer": "Customer",
    "conditions": "Conditions",
    "equipment": "Equipment",
    "calibration": "Calibration",
    "measurement_uncertainty": "Measurement uncertainty",
    "decision_rule": "Decision rule",
}
_SIMPLE_ACCEPTANCE = "simple acceptance: value against limit, no guard band (ILAC-G8)"


def laboratory_facts(recording: Recording, result: RunResult | None) -> tuple[Fact, ...]:
    """What ISO/IEC 17025 (7.8) asks of a test report beside its results, as far as it is stated."""
    if result is None:
        return ()
    stated = _stated(recording)
    missing = [_LABORATORY[key].lower() for key, value in stated.items() if not value]
    stated["decision_rule"] = stated["decision_rule"] or _SIMPLE_ACCEPTANCE
    facts = [Fact(_LABORATORY[key], value) for key, value in stated.items() if value]
    return (*facts, *([Fact("Not stated", ", ".join(missing))] if missing else []))


def _stated(recording: Recording) -> dict[str, str]:
    """Each field of a test report with what the bench file says; '' where it says nothing."""
    given = recording.metadata.get("report", {})
    dates = recording.metadata.get("calibration", {})
    stated = {key: given.get(key, "").strip() for key in _LABORATORY}
    stated["calibration"] = "; ".join(f"{_words(sensor)} until {until}" for sensor, until in dates.items())
    return stated


def identity(recording: Recording, result: RunResult | None) -> str:
    """One line for the head of a report: device under test, bench, operator, start."""
    run, dut = recording.metadata.get("run", {}), recording.metadata.get("dut", {})
    operator = run.get("operator", "")
    parts = (
        " ".join(dut[key] for key in ("name", "serial") if dut.get(key)),
        run.get("bench") or (result.bench if result else ""),
        f"operator {operator}" if operator else "",
        _moment(run.get("started_at", "")),
    )
    return " · ".join(part for part in parts if part)


def run_facts(recording: Recording, result: RunResult | None) -> tuple[Fact, ...]:
    """Who, what, where and when."""
    run = recording.metadata.get("run", {})
    simulated = run.get("simulated", "").lower() == "true"
    bench = run.get("bench") or (result.bench if result else "")
    facts = [
        Fact("Plan", run.get("plan") or (result.plan if result else "")),
        Fact("Variables", run.get("variables", "")),
        Fact("Bench", f"{bench} (simulated)" if simulated else bench),
        Fact("Operator", run.get("operator", "")),
        Fact("Hazardous plan authorised by", run.get("hazard_confirmed_by", "")),
        Fact("Prompts confirmed in advance by", run.get("prompts_confirmed_by", "")),
        Fact("Vehicle and road, confirmed by the panel", _vehicle(recording)),
        Fact("Started", _moment(run.get("started_at", ""))),
    ]
    if result is not None:
        facts += [
            Fact("Time on the bench", labels.quantity(result.bench_time_s, "s", 1)),
            Fact("Real-time factor", labels.number(result.real_time_factor, significant=3)),
            Fact("Clocks", _clocks(result)),
            *timing_facts(result),
            *_bus_load_facts(result),
        ]
    elif TIME in recording and recording.samples > 1:
        span = recording.last_s - recording.first_s
        facts.append(Fact("Length", labels.quantity(span, "s")))
        facts.append(Fact("Samples", labels.number(float(recording.samples), 0)))
        facts.append(Fact("Sample time", labels.nominal(float(f"{recording.sample_time_s:.4g}"), "s")))
    return tuple(fact for fact in facts if fact.value)


def _vehicle(recording: Recording) -> str:
    return ", ".join(f"{name} {value}" for name, value in recording.metadata.get(VEHICLE, {}).items())


def _clocks(result: RunResult) -> str:
    """The worst of what is known of time: drift, offset, frames that came late or not at all."""
    if not result.clocks:
        return ""
    drift = max((abs(clock.drift_ppm) for clock in result.clocks[1:]), default=0.0)
    offset_s = max(abs(clock.offset_s) for clock in result.clocks)
    latest_s = max(clock.latest_s for clock in result.clocks)
    lost = sum(clock.lost + clock.left_out for clock in result.clocks)
    drifts = f"clock drift {labels.quantity(drift, 'ppm', 1)}"
    skew = f"channel skew {labels.quantity(offset_s * 1e3, 'ms', 2)}"
    latency = f"maximum latency {labels.quantity(latest_s * 1e3, 'ms', 1)}"
    return f"{drifts}, {skew}, {latency}, {lost} samples lost"


def timing_facts(result: RunResult) -> list[Fact]:
    """How well periodic requests kept their time, each a line; and whether the loop stood still."""
    timing = result.timing
    if timing is None:
        return []
    if timing.clock == "virtual":
        return [Fact("Timing of requests", "simulated time, no jitter")]
    facts = [Fact(f"Timing, {r.device} {r.request}", _request(r)) for r in timing.requests]
    if timing.pauses:
        longest = labels.quantity(timing.longest_pause_s, "s", 3)
        facts.append(Fact("Service stalled", f"{timing.pauses} times, longest {longest}"))
    return facts


def _bus_load_facts(result: RunResult) -> list[Fact]:
    return [
        Fact(
            f"Load of bus '{load.bus}'",
            f"mean ≤ {100.0 * load.mean:.0f} %, peak (0.1 s) ≤ {100.0 * load.busiest:.0f} % of "
            f"{labels.quantity(load.bit_rate / 1e3, 'kbit/s', 0)}",
        )
        for load in result.bus_loads
    ]


def _request(request: PeriodicRequests) -> str:
    """Late by how much when sent, and when seen on the bus."""
    parts = (
        f"{request.count} every {labels.quantity(request.period_s * 1e3, 'ms', 0)}",
        f"sent {_late(request.sent)}",
        f"on the bus {_late(request.seen) if request.seen else f'not known: {request.why_not_seen}'}",
        request.missed_in_words,
    )
    return ", ".join(parts)


def _late(late: Lateness) -> str:
    figures = ((late.p50_ms, "p50"), (late.p99_ms, "p99"), (late.max_ms, "largest"))
    return " ".join(f"{name} {labels.quantity(value, 'ms', 2)}" for value, name in figures) + " late"


def simulated(recording: Recording) -> bool:
    """True if the bench was a simulated one."""
    return recording.metadata.get("run", {}).get("simulated", "").lower() == "true"


def calibration_facts(recording: Recording, result: RunResult | None = None) -> tuple[Fact, ...]:
    """Until when each sensor's calibration is valid at the start of the run, and who let it run out."""
    accepted = result.accepted_expired if result else None
    words = f", accepted by {accepted.by}: {accepted.reason}" if accepted else ""
    started = _date(recording.metadata.get("run", {}).get("started_at", ""))
    facts = []
    for sensor, until in recording.metadata.get("calibration", {}).items():
        expires = _date(until)
        if started is None or expires is None:
            facts.append(Fact(_words(sensor), until))
        elif expires < started:
            facts.append(Fact(_words(sensor), f"{until}, expired before the run{words}", "bad"))
        else:
            facts.append(Fact(_words(sensor), until, "good"))
    return tuple(facts)


def stored_files(recording: Recording) -> tuple[StoredFile, ...]:
    """Attachments, each hashed again and compared with the hash stored during the run."""
    stored = recording.metadata.get("hashes", {})
    files = []
    for name, content in recording.attachments.items():
        now = hashlib.sha256(content).hexdigest()
        then = stored.get(name, "")
        check = "matches" if then.lower() == now else "does not match" if then else "no stored hash"
        state = {"matches": "good", "does not match": "bad"}.get(check, "")
        files.append(StoredFile(name, labels.file_size(len(content)), now, check, state))
    for name in stored.keys() - recording.attachments.keys():
        files.append(StoredFile(name, labels.DASH, stored[name], "has no file in the recording", "bad"))
    return tuple(files)


def recording_hash(recording: Recording) -> str:
    """SHA-256 of the recording's file, '' if it cannot be read."""
    try:
        return sha256_of(recording.source)
    except BadInputError:
        return ""


def controller_table(recording: Recording) -> ControllerTable | None:
    """Parameters of the attached controllers; None without any. A file that is no TOML is passed over."""
    columns: dict[str, dict[str, str]] = {}
    for name, content in recording.attachments.items():
        if not name.startswith(_CONTROLLER):
            continue
        try:
            values = parse_toml(content.decode(), name)
        except (UnicodeDecodeError, BadInputError):
            continue
        columns[name.removeprefix(_CONTROLLER).removesuffix(".toml")] = dict(_flat(values))
    keys = dict.fromkeys(key for column in columns.values() for key in column)
    rows = tuple((key, tuple(c.get(key, labels.DASH) for c in columns.values())) for key in keys)
    return ControllerTable(tuple(columns), rows) if rows else None


def _flat(values: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    pairs = []
    for key, value in values.items():
        if not prefix and key in _NOT_SHOWN:
            continue
        if isinstance(value, dict):
            pairs += _flat(value, f"{prefix}{key}.")
        elif isinstance(value, float) and math.isfinite(value):
            pairs.append((prefix + key, labels.nominal(value)))
        else:
            pairs.append((prefix + key, str(value)))
    return pairs


def _words(key: str) -> str:
    return labels.capitalised(key.replace("_", " "))


def _date(text: str) -> datetime.date | None:
    try:
        return datetime.date.fromisoformat(text.strip()[:10])
    except ValueError:
        return None


def _moment(text: str) -> str:
    """'2026-03-04T09:15:00.250+01:00' as '2026-03-04 09:15:00.250 +01:00'; another text as it is."""
    try:
        moment = datetime.datetime.fromisoformat(text)
    except ValueError:
        return text
    zone = moment.strftime("%z")
    words = moment.replace(tzinfo=None).isoformat(" ", "milliseconds" if moment.microsecond else "seconds")
    return f"{words} {zone[:3]}:{zone[3:5]}" if zone else words
