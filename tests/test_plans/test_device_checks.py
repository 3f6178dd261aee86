"""What any device must do: bounds that suit small and large steps, and what is not checked is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from test_plans import CHECKS, Plan, plan_from_text


def plan_of(step: str, device: str = "{}") -> Plan:
    text = f"name: test\ndevice: {device}\nsteps: [{{step: {{segment: s, before_s: 0.5, {step}}}}}]\n"
    return plan_from_text(text, "plan.yaml", Path())


def bounds(plan: Plan) -> dict[str, float | None]:
    return {one.id.partition(".")[2]: one.upper for one in plan.device_criteria}


def test_bounds_are_of_the_larger_torque() -> None:
    found = bounds(plan_of("quantity: driving_torque, from_nm: 300, to_nm: 326, after_s: 4"))
    assert found["stability_oscillation"] == pytest.approx(32.6)
    # A response that misses more than half of the step is none, however small the step is.
    assert (found["arrival"], found["holding"]) == (50.0, 100.0)


def test_small_steps_are_judged_as_if_they_were_larger() -> None:
    assert bounds(plan_of("quantity: driving_torque, from_nm: 0, to_nm: 5, after_s: 4"))[
        "stability_oscillation"
    ] == pytest.approx(2.5)


def test_a_usual_step_has_every_check() -> None:
    found = bounds(plan_of("quantity: driving_torque, from_nm: 0, to_nm: 200, after_s: 4"))
    assert tuple(found) == CHECKS
    assert found == pytest.approx(dict(zip(CHECKS, (2.0, 10.0, 20.0, 20.0, 0.05), strict=True)))
    motor = bounds(plan_of("quantity: motor_torque, from_nm: 0, to_nm: 25, after_s: 4"))
    assert motor == pytest.approx(dict(zip(CHECKS[:4], (2.0, 10.0, 20.0, 2.5), strict=True)))


def test_what_is_not_checked_is_named() -> None:
    usual = "quantity: driving_torque, from_nm: 0, to_nm: 200"
    assert plan_of(f"{usual}, after_s: 4").device_gaps == ()
    left_out = plan_of(f"{usual}, after_s: 4", "{response_s: null, arrival_percent: null}").device_gaps
    assert left_out == ("the plan takes out device.arrival_percent, device.response_s",)
    (short,) = plan_of(f"{usual}, after_s: 0.6").device_gaps
    assert "segment 's': 0.6 s at its last level are too short" in short


@pytest.mark.parametrize(
    ("device", "said"),
    [
        ("{arival_percent: 5}", "unknown key 'arival_percent'"),
        ("{arrival_percent: -5}", "-5 must be more than 0"),
        ("5", "5 must be a table"),
    ],
)
def test_wrong_bounds_are_named_by_their_key(device: str, said: str) -> None:
    with pytest.raises(BadInputError, match=said):
        plan_of("quantity: driving_torque, from_nm: 0, to_nm: 200", device)


def test_ramps_and_stairs_end_at_a_level_too() -> None:
    text = """
name: test
steps:
  - ramp: {segment: slow, quantity: driving_torque, from_nm: 0, to_nm: 200, duration_s: 3, after_s: 4}
  - ramp: {segment: short, quantity: driving_torque, from_nm: 0, to_nm: 200, duration_s: 3, after_s: 2}
  - stairs: {segment: up, quantity: driving_torque, levels_nm: [0, 100, 200], hold_s: 2}
  - chirp: {segment: c, quantity: driving_torque, from_hz: 1, to_hz: 9, amplitude_nm: 10, duration_s: 4}
"""
    plan = plan_from_text(text, "plan.yaml", Path())
    assert [one.segment for one in plan.device_criteria if one.id.endswith("holding")] == ["slow", "up"]
    (short, chirp) = plan.device_gaps
    assert "segment 'short': 2 s at its last level" in short
    assert "segment 'c': a chirp of driving torque ends at no level" in chirp
    assert bounds(plan)["response_time"] == pytest.approx(1.0)  # of the stairs, the last
