"""Limits, holds and end steps in the report."""

from __future__ import annotations

from hil.core.recording import Recording
from hil.core.result import Hold, LimitResult, RunResult
from reports.content import content
from reports.guards import hold_facts, limit_facts

LIMITS = (
    LimitResult(name="motor_speed_rad_s", channel="motor_speed_rad_s", unit="rad/s", below=-700, above=700,
                persistence_s=0.005, response="trip", lowest=-1.5, highest=123.4),
    LimitResult(name="oil", channel="oil_temperature_k", unit="K", above=353, persistence_samples=4,
                response="pause", lowest=290, highest=355.5, reached=2),
    LimitResult(name="jerk", channel="motor_torque_nm", of="slope", unit="N m/s", above=9000,
                persistence_s=0.01, response="warn", lowest=None, highest=None),
)  # fmt: skip


def test_what_was_reached_beside_what_is_allowed(result: RunResult) -> None:
    speed, oil, jerk = limit_facts(result.model_copy(update={"limits": LIMITS}))
    assert (speed.name, speed.state) == ("motor_speed_rad_s", "good")
    assert "to 123.4 rad/s; limit 700 rad/s, for 5 ms: trip" in speed.value
    assert oil.state == "bad"
    assert oil.value.endswith("at most 353 K, for 4 samples: pause; reached 2 times")
    assert jerk.value.startswith("slope of motor_torque_nm nothing known")


def test_holds_and_end_steps(recording: Recording, result: RunResult) -> None:
    held = Hold(start_s=3.0, end_s=5.5, cause="cage_shut reached 0 1", ended_by="well again")
    named = result.model_copy(update={"holds": (held,), "end_steps": "executed: ramp_down"})
    first, last = hold_facts(named)
    assert first.name.replace("\u202f", " ") == "3.0 s to 5.5 s"
    assert first.value == "held: cage_shut reached 0 1; ended by: well again"
    assert last.value == "executed: ramp_down"
    assert content(recording, named).holds == (first, last)
    assert (limit_facts(None), hold_facts(None)) == ((), ())
