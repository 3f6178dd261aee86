"""Turns the axle a little and looks which way every sensor says that it went."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.errors.mistakes import line_of
from hil.core.recording import Recording, read_recording
from hil.core.result import Segment
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.ipc.ipc import Progress, RunOutcome, RunRequest, Terminal
from hil.engine.run.run import run_plan
from hil.engine.stop.stopping import StopRequest
from test_plans import Plan, plan_from_text

DRIVEN, TURNED = "driven", "turned"
_LARGEST_TORQUE_NM = 30.0
_SPEED_KM_H = 0.5  # so slow that it counts as reached whatever a sensor of the wrong sign says
_BEFORE_S, _DRIVE_S, _HOLD_S = 0.5, 3.0, 1.0
_LOOK_S = 0.3
_SURE = 6.0  # standard errors by which a reading must have changed

Verdict = Literal["right", "wrong", "not_seen", "not_there"]


@dataclass(frozen=True)
class Sign:
    """What a sensor read when something was asked for that makes it positive.

    Attributes:
        test: what was asked for: "motor torque, vehicle released", "dynos at 1.5 km/h".
        change: reading then less reading before, in `unit`; None if the channel was not recorded.
        verdict: `not_seen`: it did not change by more than its noise.
    """

    channel: str
    unit: str
    test: str
    change: float | None
    verdict: Verdict


@dataclass(frozen=True)
class SignFinding:
    """A wrong sign: what, where in the bench file, and what to look at."""

    what: str
    where: str
    fix: str


@dataclass(frozen=True)
class Signs:
    """Every sign that was looked at, and what follows from them together."""

    signs: tuple[Sign, ...]
    findings: tuple[SignFinding, ...] = field(default=())

    @property
    def right(self) -> bool:
        """Whether every sign was seen and is right."""
        return bool(self.signs) and all(sign.verdict == "right" for sign in self.signs)


@dataclass
class JogRequest:
    """A bench whose axle is to be turned; the rest is that of a `RunRequest`.

    Attributes:
        torque_nm: at the motor.
    """

    bench: BenchFile
    out: Path
    torque_nm: float = 10.0
    operator: str = ""
    terminal: Terminal | None = None
    confirmed_by: str = ""
    progress: Progress = lambda share, text: None
    replaces: tuple[Path, ...] = ()
    stop: StopRequest = field(default_factory=StopRequest)


@dataclass(frozen=True)
class JogOutcome:
    """How the run ended, and the signs as far as it came."""

    run: RunOutcome
    signs: Signs


_SPEEDS = (
    ("motor_speed_rad_s", "rad/s", 0.3),
    ("wheel_speed_left_rad_s", "rad/s", 0.04),
    ("wheel_speed_right_rad_s", "rad/s", 0.04),
)
_SHAFTS = (("shaft_torque_left_nm", "N m", 1.0), ("shaft_torque_right_nm", "N m", 1.0))
_MOTOR = (("motor_torque_ref_nm", "N m", 0.2), ("motor_torque_nm", "N m", 0.2))
_VEHICLE = (("vehicle_speed_m_s", "m/s", 0.01),)
#: Which channels must become positive in which test, with the least change that is one.
_TESTS: dict[str, tuple[tuple[str, str, float], ...]] = {
    "motor torque": (*_MOTOR, *_SHAFTS, *_SPEEDS, *_VEHICLE),
    "dynos forwards": _SPEEDS,
}


def jog_plan(torque_nm: float, bench: BenchFile) -> Plan:
    """The plan that turns the axle.

    Raises:
        BadInputError: the torque makes no sense, or is beyond the bench's limit.
    """
    largest = min(_LARGEST_TORQUE_NM, bench.limits.motor_torque_nm)
    if not 0.5 <= torque_nm <= largest:
        raise BadInputError(
            f"--torque is {torque_nm:g}",
            fix=f"give 0.5 to {largest:g} N m at the motor; higher torque is not allowed for jogging",
        )
    return plan_from_text(
        f"""
name: jog
title: Signs of every sensor
steps:
  - operator_prompt:
      text: >-
        The axle will turn forwards, by {torque_nm:g} N m at the motor and at {_SPEED_KM_H:g} km/h, and stop
        by itself. Keep clear of wheels and shafts.
  - hold_speed: {{speed_km_h: 0, duration_s: 0.5}}
  - step: {{segment: {DRIVEN}, quantity: motor_torque, load: vehicle, from_nm: 0, to_nm: {torque_nm:g},
            before_s: {_BEFORE_S:g}, after_s: {_DRIVE_S:g}}}
  - hold_speed: {{speed_km_h: 0, duration_s: 1}}
  - operator_prompt: {{text: "Did both wheels turn forwards, as a car drives ahead? Ctrl-C if not."}}
  - hold_speed: {{speed_km_h: {_SPEED_KM_H:g}, duration_s: 1}}
  - step: {{segment: {TURNED}, quantity: motor_torque, load: speed, from_nm: 0, to_nm: {torque_nm:g},
            before_s: {_BEFORE_S:g}, after_s: {_HOLD_S:g}}}
  - hold_speed: {{speed_km_h: 0, duration_s: 0.5}}
  - operator_prompt: {{text: "Did both wheels turn forwards this time, too? Ctrl-C if not."}}
finally:
  - ramp_down: {{duration_s: 1}}
criteria: []
""",
        "hil bench jog",
        Path(),
    )


def jog_bench(bench: BenchFile, torque_nm: float) -> BenchFile:
    """The bench with limits that suit a jog: what runs away because a sign is wrong is stopped early."""
    limits = bench.limits
    near = {
        "motor_torque_nm": min(limits.motor_torque_nm, 1.5 * torque_nm),
        "motor_speed_rad_s": min(limits.motor_speed_rad_s, 80.0),
        "wheel_speed_rad_s": min(limits.wheel_speed_rad_s, 10.0),
        "vehicle_speed_m_s": min(limits.vehicle_speed_m_s, 3.0),
    }
    return bench.model_copy(update={"limits": limits.model_copy(update=near)})


def jog(request: JogRequest) -> JogOutcome:
    """Turn the axle as a run does, with its limits, its recording and its safe state, and look at the signs.

    Raises:
        BadInputError: nothing was moved: a senseless torque, no one to ask, a calibration that has run out.
        BenchError: nothing was moved: the bench does not come up.
    """
    bench = jog_bench(request.bench, request.torque_nm)
    run = RunRequest(
        plan=jog_plan(request.torque_nm, request.bench),
        bench=bench,
        out=request.out,
        operator=request.operator,
        terminal=request.terminal,
        confirmed_by=request.confirmed_by,
        progress=request.progress,
        replaces=request.replaces,
        stop=request.stop,
    )
    outcome = run_plan(run)
    recording = read_recording(outcome.recording, least_samples=0, allow_missing=True)
    return JogOutcome(outcome, signs_of(recording, outcome.result.segments, request.bench))


def signs_of(recording: Recording, segments: Sequence[Segment], bench: BenchFile) -> Signs:
    """What the sensors read in a jog, also in one that was cut off."""
    found: list[Sign] = []
    at = {segment.id: segment for segment in segments}
    if DRIVEN in at:
        start_s, step_s, end_s = at[DRIVEN].start_s, at[DRIVEN].step_s, at[DRIVEN].end_s
        found += _seen(recording, "motor torque", (start_s, step_s), (max(step_s, end_s - _LOOK_S), end_s))
        if TURNED in at:
            before, turning = (start_s, step_s), (at[TURNED].start_s, at[TURNED].step_s)
            found += _seen(recording, "dynos forwards", before, turning)
    return Signs(tuple(found), tuple(_findings(found, bench)))


def _seen(
    recording: Recording, test: str, before: tuple[float, float], then: tuple[float, float]
) -> list[Sign]:
    signs = []
    for channel, unit, least in _TESTS[test]:
        if channel not in recording.channels:
            signs.append(Sign(channel, unit, test, None, "not_there"))
            continue
        rest, moved = (_values(recording, channel, *span) for span in (before, then))
        if not (len(rest) and len(moved)):
            signs.append(Sign(channel, unit, test, None, "not_seen"))
            continue
        change = float(moved.mean() - rest.mean())
        error = math.hypot(rest.std() / math.sqrt(len(rest)), moved.std() / math.sqrt(len(moved)))
        seen = abs(change) > max(least, _SURE * error)
        verdict: Verdict = "not_seen" if not seen else "right" if change > 0 else "wrong"
        signs.append(Sign(channel, unit, test, change, verdict))
    return signs


def _values(recording: Recording, channel: str, first_s: float, last_s: float) -> npt.NDArray[np.float64]:
    inside = (recording.time_s >= first_s) & (recording.time_s < last_s)
    values = recording[channel][inside]
    return values[np.isfinite(values)]


def _findings(signs: Sequence[Sign], bench: BenchFile) -> Iterator[SignFinding]:
    """What is behind the signs: a command that is turned round, or single sensors."""
    blamed: set[str] = set()
    for test, culprit, key, names in (
        ("motor torque", "the RMCU's torque request", "rmcu.dbc", (*_SHAFTS, *_SPEEDS)),
        ("dynos forwards", "'Target velocity' of the dynos", "dyno.eds", _SPEEDS),
    ):
        verdicts = {sign.channel: sign.verdict for sign in signs if sign.test == test}
        if verdicts and all(verdicts.get(name) == "wrong" for name, _, _ in names):
            blamed.add(test)
            what = f"{test}: every sensor says that the axle turned backwards"
            fix = f"invert the sign of {culprit} (its factor in the file), or check phases and wiring"
            yield SignFinding(what, _place(bench, key), fix)
    for channel in dict.fromkeys(sign.channel for sign in signs):
        wrong = [s for s in signs if s.channel == channel and s.verdict == "wrong" and s.test not in blamed]
        unseen = [s for s in signs if s.channel == channel and s.verdict in ("not_seen", "not_there")]
        where = _described(bench, channel)
        if wrong:
            shown = ", ".join(f"{s.change:.3g} {s.unit} ({s.test})" for s in wrong if s.change is not None)
            fix = "invert the sign of its factor there, or correct the sensor's wiring"
            yield SignFinding(f"{channel} has the wrong sign: it changed by {shown}", where, fix)
        elif unseen:
            tests = " and ".join(s.test for s in unseen)
            fix = "check that the sensor is connected and the wheel is free; else increase --torque"
            yield SignFinding(f"{channel} did not move ({tests})", where, fix)


def _described(bench: BenchFile, channel: str) -> str:
    """Where the sign of a channel is decided: line of the bench file, and what to look for there."""
    for key, table in bench.device_tables.items():
        found = table.described_in().get(channel)
        if found is not None:
            return f"{_place(bench, f'{key}.{found[0]}')}: {found[1]}"
    return str(bench.source)


def _place(bench: BenchFile, key: str) -> str:
    line = line_of(bench.text, key)
    return f"{bench.source}, line {line} ({key})" if line else f"{bench.source} ({key})"
