"""Ids of criteria and device checks: one for each, whatever a plan's author asks."""

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from test_plans import plan_from_text

PLAN = """
name: p
title: p
steps:
  - set_controller: {file: phase_stabilization.toml}
  - step: {segment: up, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 1, after_s: 8}
  - chirp: {segment: sweep, quantity: motor_torque, bias_nm: 10, amplitude_nm: 20, from_hz: 0.5, to_hz: 20,
      duration_s: 10}
criteria:
  - CRITERION
"""


def read(criterion: str):
    return plan_from_text(PLAN.replace("CRITERION", criterion), "plan.yaml", Path(), files_required=False)


def test_a_check_whose_name_the_plan_has_taken_gets_another() -> None:
    plan = read("{segment: up, metric: response_time, channel: shaft_torque_nm, upper: 0.01}")
    ids = [one.id for one in (*plan.criteria, *plan.device_criteria)]
    assert len(set(ids)) == len(ids)
    assert {"up.response_time", "up.device_response_time", "up.arrival"} <= set(ids)


@pytest.mark.parametrize(
    ("criterion", "words"),
    [
        ("{segment: sweep, metric: trough, channel: shaft_torque_nm, lower: 0}", "no step"),
        ("{segment: up, metric: jerk, upper: -1}", "never negative"),
        ("{segment: up, metric: jerk, upper: 5, low_pass_hz: 5000}", "low_pass_hz"),
    ],
)
def test_what_can_never_be_met_or_computed_is_refused_where_it_stands(criterion: str, words: str) -> None:
    with pytest.raises(BadInputError, match=words):
        read(criterion)


def test_a_chirp_through_zero_leaves_a_flank() -> None:
    assert read("{segment: sweep, metric: clunk, firm_nm: 20, upper: 1000}").criteria
