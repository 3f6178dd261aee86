"""A run that is held: by an interlock, a limit, the operator; resumed where it was, or ended in order."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil.core.errors import BenchError, EmergencyStopError, InterruptError, OrderlyEndError
from hil.core.recording import read_recording
from hil.engine import RunOutcome, RunRequest, run_plan
from hil.engine.bench.ranges import NamedLimit
from hil.engine.stop.emergency_stop import reset
from tests.benches_for_tests import SIM, plan, sim_bench
from tests.hil.engine.cages import cage, shut
from tests.operators import Silent

STEPS = """
  - hold_speed: {speed_km_h: 5, duration_s: 0.2}
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 10, before_s: 0.2, after_s: 2}
"""
PEAK = "[{segment: s, metric: peak, channel: motor_torque_ref_nm, to_s: 1, upper: 11, unit: N m}]"
END = "[{ramp_down: {duration_s: 0.5}}]"
Reading = Callable[[float], float]


def held(tmp_path: Path, name: str, reading: Reading = lambda s: 1.0, **changes: Any) -> RunOutcome:
    terminal, steps = changes.pop("terminal", None), changes.pop("steps", STEPS)
    changes.setdefault("interlocks", shut())
    file = sim_bench(name, devices=cage(reading), **changes)
    return run_plan(RunRequest(plan(steps, PEAK, END), file, tmp_path, terminal=terminal))


def events(outcome: RunOutcome, kind: str) -> list[str]:
    return [e.text for e in read_recording(outcome.recording, allow_missing=True).events if e.kind == kind]


def open_between(from_s: float, to_s: float, value: float = 0.0) -> Reading:
    return lambda now_s: value if from_s <= now_s < to_s else 1.0


def typing_at(when_s: float, operator: Silent, line: str) -> Reading:
    """A shut cage, and an operator who types a line at a time of the bench."""

    def read(now_s: float) -> float:
        if when_s <= now_s < when_s + 0.01:
            operator.waiting.append(line)
        return 1.0

    return read


def test_an_interlock_holds_the_run_and_the_step_is_begun_again(tmp_path: Path) -> None:
    outcome = held(tmp_path, "held", open_between(3.0, 4.0))
    assert (outcome.error, outcome.result.verdict, outcome.result.safe_state) == (None, "pass", "confirmed")
    cut, whole = outcome.result.segments
    assert (cut.id, cut.complete, whole.id, whole.complete) == ("s_held_1", False, "s", True)
    assert (cut.load, whole.load) == ("vehicle", "vehicle")
    (hold,) = outcome.result.holds
    assert hold.ended_by == "well again"
    assert hold.end_s - hold.start_s == pytest.approx(2.0, abs=0.3)  # a second open, a second well again
    assert cut.end_s < hold.start_s < hold.end_s < whole.start_s
    recording = read_recording(outcome.recording, allow_missing=True)
    inside = recording.between(hold.start_s + 0.01, hold.end_s)
    assert np.all(inside["motor_torque_ref_nm"] == 0.0)
    assert np.ptp(inside["wheel_speed_rad_s"]) < 1.0  # its speed is held
    started = recording.between(whole.start_s, whole.start_s + 0.1)["vehicle_speed_m_s"]
    assert np.allclose(started, 5 / 3.6, atol=0.2)  # as it was started the first time
    assert (len(events(outcome, "hold")), outcome.result.end_steps[:11]) == (2, "executed")


def test_dynos_that_held_their_speed_hold_it_again(tmp_path: Path) -> None:
    steps = STEPS.replace("motor_torque, ", "motor_torque, load: speed, ")
    outcome = held(tmp_path, "speed", open_between(3.0, 3.5), steps=steps)
    assert outcome.error is None
    cut, whole = outcome.result.segments
    assert (cut.id, cut.load, whole.load) == ("s_held_1", "speed", "speed")
    ended = read_recording(outcome.recording, allow_missing=True).between(whole.end_s - 0.1, whole.end_s)
    assert np.allclose(ended["vehicle_speed_m_s"], 5 / 3.6, atol=0.05)


def test_torque_is_taken_away_by_a_ramp(tmp_path: Path) -> None:
    outcome = held(tmp_path, "ramp", open_between(3.0, 4.0))
    recording = read_recording(outcome.recording, allow_missing=True)
    cut, hold = outcome.result.segments[0], outcome.result.holds[0]
    torque = recording.between(cut.end_s - 0.05, hold.start_s)["motor_torque_ref_nm"]
    assert torque[0] == pytest.approx(10.0)
    assert np.max(np.abs(np.diff(torque))) < 0.2


def test_an_interlock_that_stays_open_ends_the_run_with_its_end_steps(tmp_path: Path) -> None:
    outcome = held(tmp_path, "ended", open_between(3.0, 99.0), interlocks=shut(timeout_s=1.5))
    assert isinstance(outcome.error, OrderlyEndError)
    assert outcome.error.fix == "shut the cage"
    assert outcome.result.end_steps.startswith("executed: ramp_down; the wheels turn at 0.0")
    assert outcome.result.holds[0].ended_by == "end of the run"
    assert {c.verdict for c in outcome.result.criteria} == {"not_judged"}
    assert outcome.result.safe_state == "confirmed"


def test_what_opens_again_and_again_does_not_hold_for_ever(tmp_path: Path) -> None:
    def flaps(now_s: float) -> float:
        return float(now_s < 3.0 or (now_s % 1.5) > 0.3)

    outcome = held(tmp_path, "flaps", flaps, interlocks=shut(well_for_s=0.1))
    assert isinstance(outcome.error, OrderlyEndError)
    assert "it has already held the run 5 times" in outcome.error.what


def test_an_open_interlock_keeps_the_bench_from_being_armed(tmp_path: Path) -> None:
    outcome = held(tmp_path, "open", open_between(0.0, 99.0))
    assert isinstance(outcome.error, BenchError)
    assert (outcome.error.where, outcome.error.fix) == ("interlock 'cage'", "shut the cage")
    assert not events(outcome, "arm")


def limits(response: str, **keys: Any) -> Any:
    named = NamedLimit(channel="shaft_torque_left_nm", unit="N m", above=20.0, response=response, **keys)  # type: ignore[arg-type]
    return SIM.limits.model_copy(update={"watch": {"twist": named}})


def test_a_warning_ends_nothing_and_is_told_once(tmp_path: Path) -> None:
    outcome = held(tmp_path, "warned", limits=limits("warn", hysteresis=5.0))
    assert (outcome.error, outcome.result.verdict) == (None, "pass")
    (said,) = events(outcome, "limit")
    assert "response: warn" in said
    (limit,) = [limit for limit in outcome.result.limits if limit.name == "twist"]
    assert (limit.reached, limit.above, limit.response) == (1, 20.0, "warn")
    assert limit.highest is not None
    assert limit.highest > 20.0


def test_ramp_down_ends_the_run_with_its_end_steps_and_no_jump_of_torque(tmp_path: Path) -> None:
    outcome = held(tmp_path, "down", limits=limits("ramp_down"))
    assert isinstance(outcome.error, OrderlyEndError)
    assert "shaft_torque_left_nm reached" in outcome.error.what
    assert outcome.result.end_steps.startswith("executed: ramp_down")
    torque = read_recording(outcome.recording, allow_missing=True)["motor_torque_ref_nm"]
    assert np.min(np.diff(torque)) > -0.2


@pytest.mark.parametrize("reached_s", [2.9, 3.6])
def test_what_is_reached_at_the_very_end_still_ends_the_run_in_error(
    reached_s: float, tmp_path: Path
) -> None:
    """In the last step, or in the end steps: nothing is left that could be held."""
    named = NamedLimit(channel="cage_shut", unit="1", below=0.5, response="ramp_down", persistence_samples=0)
    limited = SIM.limits.model_copy(update={"watch": {"late": named}})
    file = sim_bench(
        f"late-{reached_s}", devices=cage(open_between(reached_s, 99.0)), limits=limited, interlocks={}
    )
    waits = plan("[{wait: {duration_s: 2.35}}]", end="[{ramp_down: {duration_s: 1.5}}]")
    outcome = run_plan(RunRequest(waits, file, tmp_path))
    assert isinstance(outcome.error, OrderlyEndError)
    assert outcome.result.end_steps.startswith("executed")
    assert outcome.result.verdict == "error"


def test_a_pause_without_an_operator_ends_the_run_in_order(tmp_path: Path) -> None:
    outcome = held(tmp_path, "no one", limits=limits("pause"))
    assert isinstance(outcome.error, OrderlyEndError)
    assert "no terminal" in outcome.error.what
    assert outcome.result.end_steps.startswith("executed")


def test_a_limit_pauses_until_the_operator_lets_it_go_on(tmp_path: Path) -> None:
    operator = Silent()

    def answer(text: str) -> None:
        if "r and Enter" in text:
            operator.waiting.append("r" if len(operator.told) < 8 else "q")

    operator.then = answer
    outcome = held(tmp_path, "paused", limits=limits("pause"), terminal=operator)
    assert [hold.ended_by for hold in outcome.result.holds][:2] == ["operator", "operator"]
    assert isinstance(outcome.error, (OrderlyEndError, InterruptError))  # it is reached each time


@pytest.mark.parametrize(("typed", "error"), [("p", None), ("q", InterruptError)])
def test_the_operator_pauses_or_ends(typed: str, error: Any, tmp_path: Path) -> None:
    operator = Silent()
    operator.then = lambda text: operator.waiting.append("r") if text.startswith("held") else None
    reading = typing_at(3.0, operator, typed)
    outcome = held(tmp_path, f"operator-{typed}", reading, terminal=operator)
    assert outcome.error is None if error is None else isinstance(outcome.error, error)
    if error is None:
        assert (outcome.result.verdict, outcome.result.holds[0].ended_by) == ("pass", "operator")
    assert outcome.result.end_steps.startswith("executed")


@pytest.mark.parametrize("way", ["operator", "device", "interlock"])
def test_an_emergency_stop_moves_nothing_any_more(way: str, tmp_path: Path) -> None:
    operator = Silent()
    readings = {
        "operator": typing_at(3.0, operator, "e"),
        "device": open_between(3.0, 9.0, -1.0),
        "interlock": open_between(3.0, 9.0),
    }
    locks = shut(response="emergency_stop") if way == "interlock" else {}
    outcome = held(tmp_path, f"stop-{way}", readings[way], terminal=operator, interlocks=locks)
    assert isinstance(outcome.error, EmergencyStopError)
    assert outcome.result.end_steps.startswith("not executed")
    assert outcome.result.safe_state == "confirmed"
    assert events(outcome, "emergency_stop")
    assert outcome.result.emergency_stop is not None
    assert outcome.result.emergency_stop.latched
    with pytest.raises(BenchError, match="emergency stop since"):
        held(tmp_path / "again", f"stop-{way}", interlocks={})
    (stop,) = reset(sim_bench(f"stop-{way}"), "A. Tester")
    assert (stop.by, stop.reset_by) == (outcome.result.emergency_stop.by, "A. Tester")
    assert held(tmp_path / "reset", f"stop-{way}", interlocks={}).error is None
