from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest

from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment, verdict_of
from test_plans import Metric, judge
from tests.test_plans.signals import STEP as UP
from tests.test_plans.signals import recording_of, time_axis
from tests.test_plans.writing import STEP, plan_of

OTHER = UP.model_copy(update={"id": "other"})
PEAK = {"segment": "up", "metric": "peak_shaft_torque"}


def constant(value: float) -> Recording:
    time = time_axis()
    return recording_of(time, shaft_torque_nm=np.full(len(time), value))


def result(recording: Recording, *segments: Segment, **keys: Any) -> CriterionResult:
    plan = plan_of({"step": STEP}, {"step": STEP | {"segment": "other"}}, criteria=[PEAK | keys])
    return judge(plan, recording, segments)[0]


@pytest.mark.parametrize(
    ("limits", "verdict"),
    [
        ({}, "informational"),
        ({"upper": 400}, "pass"),
        ({"upper": 350}, "pass"),
        ({"upper": 349.9}, "fail"),
        ({"lower": 350}, "pass"),
        ({"lower": 351}, "fail"),
        ({"lower": 300, "upper": 400}, "pass"),
    ],
)
def test_limits_may_be_reached(limits: dict[str, float], verdict: str) -> None:
    judged = result(constant(350.0), UP, title="Peak", **limits)
    assert judged.verdict == verdict
    assert (judged.id, judged.value, judged.unit, judged.title) == (
        "up.peak_shaft_torque",
        350.0,
        "N m",
        "Peak",
    )
    assert judged.definition.startswith("Value of shaft_torque_nm")


@pytest.mark.parametrize(("mine", "verdict"), [(349.0, "pass"), (350.0, "fail"), (351.0, "fail")])
def test_below_means_lower_not_equal(mine: float, verdict: str) -> None:
    time = time_axis(50.0)
    recording = recording_of(time, shaft_torque_nm=np.where(time < 24, mine, 350.0))
    other = Segment(
        id="other", start_s=25.0, step_s=26.0, end_s=46.0, reference_before=0.0, reference_after=0.0
    )
    judged = result(recording, UP, other, below="other")
    assert (judged.verdict, judged.value, judged.upper) == (verdict, mine, 350.0)


def test_a_segment_that_was_not_carried_out() -> None:
    judged = result(constant(1.0), upper=2)
    assert (judged.verdict, judged.value) == ("not_judged", None)
    assert judged.reason == "segment 'up' was not run"


def test_the_value_stays_when_the_other_segment_is_missing() -> None:
    judged = result(constant(1.0), UP, below="other")
    assert (judged.verdict, judged.value, judged.upper) == ("not_judged", 1.0, None)
    assert "'other' was not run" in judged.reason


def test_nothing_is_judged_in_a_segment_that_was_stopped() -> None:
    stopped = UP.model_copy(update={"end_s": 22.0, "complete": False})
    judged = result(constant(1.0), stopped, to_s=10, upper=2)  # the window itself would be whole
    assert (judged.verdict, judged.value) == ("not_judged", None)
    assert judged.reason == "segment 'up' was stopped after 20 s"


def test_a_segment_shorter_than_the_window() -> None:
    judged = result(constant(1.0), UP.model_copy(update={"end_s": 5.0}), to_s=10)
    assert judged.verdict == "error"
    assert "the segment ends 2 s after the step, the window needs 10 s" in judged.reason


RINGING = {"segment": "up", "metric": "settling_shaft_torque"}


@pytest.mark.parametrize(
    ("limits", "failed"),
    [({}, False), ({"upper": 19.0}, True), ({"upper": 25.0}, True), ({"below": "other"}, True)],
)
def test_what_does_not_settle_fails_where_a_limit_asks_for_it(limits: dict[str, Any], failed: bool) -> None:
    time = time_axis(50.0)
    ringing = np.where(time < 24, 60 * np.sin(2 * np.pi * 8 * time), 0.0)
    other = UP.model_copy(update={"id": "other", "start_s": 25.0, "step_s": 26.0, "end_s": 46.0})
    plan = plan_of({"step": STEP}, {"step": STEP | {"segment": "other"}}, criteria=[RINGING | limits])
    judged = judge(plan, recording_of(time, shaft_torque_nm=ringing), [UP, other])[0]
    assert (judged.verdict, judged.value, judged.failed) == ("did_not_settle", None, failed)
    assert verdict_of([judged], stopped=False) == ("fail" if failed else "done")


def test_what_settles_is_below_what_never_does() -> None:
    time = time_axis(50.0)
    ringing = np.where(time > 24.5, 60 * np.sin(2 * np.pi * 8 * time), 0.0)
    other = UP.model_copy(update={"id": "other", "start_s": 25.0, "step_s": 26.0, "end_s": 46.0})
    criterion = RINGING | {"below": "other"}
    plan = plan_of({"step": STEP}, {"step": STEP | {"segment": "other"}}, criteria=[criterion])
    judged = judge(plan, recording_of(time, shaft_torque_nm=ringing), [UP, other])[0]
    assert (judged.verdict, judged.upper) == ("pass", None)
    assert "outside ±" in judged.reason


def test_missing_samples() -> None:
    recording = constant(1.0)
    recording["shaft_torque_nm"][5000:5003] = np.nan
    judged = result(recording, UP)
    assert judged.verdict == "error"
    assert "3 of 20001 samples of shaft_torque_nm are missing" in judged.reason


def test_a_missing_channel() -> None:
    judged = result(recording_of(time_axis(), motor_speed_rad_s=time_axis()), UP)
    assert judged.verdict == "error"
    assert "has no channel 'shaft_torque_nm'" in judged.reason


class Broken(Metric):
    """A metric with a mistake in it."""

    name: ClassVar[str] = "broken"

    @property
    def unit(self) -> str:
        return "1"

    @property
    def definition(self) -> str:
        return "One by nothing."

    def compute(self, recording: Recording, segment: Segment) -> float:
        return segment.start_s / len(recording.events)


class NotFinite(Broken):
    """A metric that overflows."""

    def compute(self, recording: Recording, segment: Segment) -> float:
        return segment.start_s * float("inf") + len(recording.events)


@pytest.mark.parametrize(
    ("metric", "says"),
    [(Broken(), "the metric failed: ZeroDivisionError"), (NotFinite(), "the value is inf")],
)
def test_a_metric_that_fails_costs_its_own_verdict_only(metric: Metric, says: str) -> None:
    plan = plan_of({"step": STEP}, criteria=[PEAK | {"id": "first"}, PEAK])
    first = plan.criteria[0].model_copy(update={"metric": metric})
    plan = plan.model_copy(update={"criteria": (first, plan.criteria[1])})
    broken, fine = judge(plan, constant(1.0), [UP], device=False)
    assert broken.verdict == "error"
    assert says in broken.reason
    assert fine.verdict == "informational"
