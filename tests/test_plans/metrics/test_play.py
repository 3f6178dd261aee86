"""Time in play, crossings, clunk and energy on torques whose passage through the play is drawn."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from test_plans import Array
from test_plans.conductor import PlannedSegment
from test_plans.metrics import Clunk, ContactEnergy, NotReachedError, NoValueError, PlayCrossings, TimeInPlay
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
OUT = STEP.model_copy(update={"reference_before": 300.0, "reference_after": -150.0, "gear_ratio": 8.0})
FIRM = 45.0  # 10 % of 450 N m


def drawn(*corners: tuple[float, float]) -> Array:
    """T_s along straight lines through (seconds after the step, N m)."""
    at, values = zip(*corners, strict=True)
    return np.interp(TIME - STEP.step_s, at, values)


PASSAGE = ((0.0, 300.0), (0.05, 20.0), (0.09, 20.0), (0.1, -200.0), (0.2, -150.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_time_in_play_is_from_flank_to_flank_in_both_directions(sign: float) -> None:
    segment = OUT.model_copy(update={"reference_before": sign * 300.0, "reference_after": sign * -150.0})
    recording = recording_of(TIME, shaft_torque_nm=sign * drawn(*PASSAGE))
    left, met = 0.05 * (300 - FIRM) / 280, 0.09 + 0.01 * (20 + FIRM) / 220
    assert TimeInPlay().compute(recording, segment) == pytest.approx(met - left, rel=1e-9)
    assert PlayCrossings().compute(recording, segment) == 1
    assert Clunk().compute(recording, segment) == pytest.approx(220 / 0.01, rel=1e-9)


def test_a_flank_that_is_only_lifted_from_is_no_crossing() -> None:
    torque = drawn((0.0, 300.0), (0.1, 0.0), (0.2, 300.0), (0.4, -150.0), (0.6, 100.0), (0.8, -150.0))
    recording = recording_of(TIME, shaft_torque_nm=torque)
    each = [2 * FIRM * 0.2 / span for span in (450.0, 250.0, 250.0)]
    assert TimeInPlay().compute(recording, OUT) == pytest.approx(sum(each), rel=1e-9)
    assert PlayCrossings().compute(recording, OUT) == 3


def test_the_last_leaving_of_a_flank_counts() -> None:
    torque = drawn((0.0, 300.0), (0.1, 0.0), (0.2, 100.0), (0.3, 0.0), (0.5, 0.0), (0.6, -100.0))
    found = TimeInPlay().compute(recording_of(TIME, shaft_torque_nm=torque), OUT)
    assert found == pytest.approx(0.545 - 0.255, rel=1e-9)


def test_a_launch_meets_a_flank_that_it_did_not_pass_to() -> None:
    launch = STEP.model_copy(update={"gear_ratio": 8.0})
    recording = recording_of(TIME, shaft_torque_nm=drawn((0.0, 0.0), (0.1, 0.0), (0.11, 200.0), (0.2, 326.0)))
    assert Clunk().compute(recording, launch) == pytest.approx(20_000.0, rel=1e-9)
    assert PlayCrossings().compute(recording, launch) == 0


def test_the_rate_counts_for_fifty_milliseconds_after_contact() -> None:
    late = drawn((0.0, 300.0), (0.1, 0.0), (0.2, -100.0), (0.3, -100.0), (0.301, -200.0))
    found = Clunk(over_s=0.001).compute(recording_of(TIME, shaft_torque_nm=late), OUT)
    assert found == pytest.approx(1000.0, rel=1e-9)


def test_the_energy_is_torque_times_the_speed_of_winding() -> None:
    """-50 N m, and a speed of winding that falls from 2 rad/s to 0 within 40 ms: 50 · 2 · 0.04 / 2 J."""
    winding = np.interp(TIME - STEP.step_s, [0.1, 0.14, 0.3], [-2.0, 0.0, 8.0])
    torque = np.where(TIME - STEP.step_s < 0.1 - 1e-6, 50.0, -50.0)
    recording = recording_of(
        TIME,
        shaft_torque_nm=torque,
        motor_speed_rad_s=8.0 * (10.0 + winding),
        wheel_speed_rad_s=0 * TIME + 10.0,
    )
    contact_s = 0.099 + 0.001 * (50 + FIRM) / 100
    before = 0.5 * (np.interp(contact_s, [0.099, 0.1], [-100.0, 100.0]) + 100.0) * (0.1 - contact_s)
    found = ContactEnergy().compute(recording, OUT)
    assert found == pytest.approx(2.0 + before, rel=1e-9)
    with pytest.raises(NoValueError, match="no gear ratio"):
        ContactEnergy().compute(recording, OUT.model_copy(update={"gear_ratio": None}))


def test_without_contact_there_is_nothing_to_judge() -> None:
    still = recording_of(TIME, shaft_torque_nm=0 * TIME)
    with pytest.raises(NotReachedError, match="meets no flank firmly"):
        Clunk().compute(still, OUT)
    for metric in (TimeInPlay(), PlayCrossings()):
        with pytest.raises(NotReachedError, match="flank"):
            metric.compute(still, OUT)


@pytest.mark.parametrize(
    ("metric", "levels", "words"),
    [
        (Clunk(), (200.0, 326.0), "keeps its sign"),
        (TimeInPlay(), (0.0, 326.0), "does not pass from flank to flank"),
        (Clunk(), (100.0, 100.0), "has no step: give 'firm_nm'"),
    ],
)
def test_a_step_that_leaves_no_flank_is_refused_when_it_is_planned(metric, levels, words) -> None:
    assert words in metric.objection(PlannedSegment("s", "step", 1.0, levels[0], levels[1], end_s=5.0))
    assert not metric.objection(PlannedSegment("s", "step", 1.0, -100.0, 300.0, end_s=5.0))


@given(st.lists(st.floats(-300, 300), min_size=2, max_size=30))
def test_crossings_are_changes_of_sign_between_firm_torques(levels: list[float]) -> None:
    at = 0.05 + 0.1 * np.arange(len(levels))
    torque = np.interp(TIME - STEP.step_s, at, levels)
    firm = [np.sign(x) for x in levels if abs(x) >= 50.0]
    changes = sum(a != b for a, b in itertools.pairwise(firm))
    recording = recording_of(TIME, shaft_torque_nm=torque)
    assume(changes > 0)
    assert PlayCrossings(firm_nm=49.0).compute(recording, OUT) >= changes
    assert PlayCrossings(firm_nm=1e-9 + 49.999999).compute(recording, OUT) >= changes
    assert TimeInPlay(firm_nm=50.0).compute(recording, OUT) >= 0


def test_one_torque_of_a_firm_contact_is_given() -> None:
    with pytest.raises(ValueError, match="stands in place of 'firm_percent'"):
        Clunk(firm_nm=20.0, firm_percent=5.0)
    assert Clunk(firm_nm=20.0).firm_percent == 10.0
