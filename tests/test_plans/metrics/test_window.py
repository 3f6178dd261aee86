from __future__ import annotations

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans import Array
from test_plans.metrics import (
    ArrivalShaftTorque,
    Clunk,
    Jerk,
    Magnitude,
    NoValueError,
    Overshoot,
    Peak,
    PlayCrossings,
    ResponseTime,
    SettlingTime,
    TimeInPlay,
    Trough,
    VibrationDose,
)
from test_plans.metrics._samples import cut, evenly
from tests.test_plans.signals import STEP, recording_of, time_axis


def torque(time: Array) -> Recording:
    return recording_of(time, shaft_torque_nm=np.ones(len(time)))


def refusal(
    recording: Recording, segment: Segment = STEP, from_s: float = 0.0, to_s: float | None = None
) -> str:
    with pytest.raises(NoValueError) as caught:
        Peak(channel="shaft_torque_nm", from_s=from_s, to_s=to_s).compute(recording, segment)
    return str(caught.value)


def test_both_ends_are_in_the_window() -> None:
    metric = Peak(channel="shaft_torque_nm", from_s=4.0, to_s=20.0)
    time, _ = metric.samples(torque(time_axis()), STEP)
    assert (time[0], time[-1], len(time)) == (7.0, 23.0, 16_001)


def test_a_segment_may_end_with_its_last_sample() -> None:
    last = STEP.model_copy(update={"end_s": 22.999})
    assert Peak(channel="shaft_torque_nm", to_s=20.0).compute(torque(time_axis(22.999)), last) == 1.0


def test_recordings_that_do_not_cover_the_window() -> None:
    assert "does not cover the window from 3.000 s to 23.000 s" in refusal(torque(time_axis(20.0)))
    assert "does not cover" in refusal(torque(time_axis()[4000:]))
    assert "does not cover" in refusal(torque(time_axis() + 100))
    assert "has 1 samples" in refusal(torque(np.array([3.0])))
    assert "has 0 samples" in refusal(torque(np.array([])))


def test_gaps() -> None:
    time = time_axis()
    assert "a gap of 0.012 s at 9.999 s" in refusal(torque(np.delete(time, slice(10_000, 10_011))))
    few_lost = torque(np.delete(time, slice(10_000, 10_009)))
    assert Peak(channel="shaft_torque_nm").compute(few_lost, STEP) == 1.0


def test_segments_too_short() -> None:
    empty = STEP.model_copy(update={"end_s": STEP.step_s})
    assert refusal(torque(time_axis()), empty) == "the window is empty"
    assert "the window needs 21 s" in refusal(torque(time_axis()), to_s=21.0)
    assert refusal(torque(time_axis()), from_s=30.0) == "the window is empty"


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_values_that_are_not_finite(bad: float) -> None:
    recording = torque(time_axis())
    recording["shaft_torque_nm"][[100, 5000]] = bad
    assert refusal(recording) == "1 of 20001 samples of shaft_torque_nm are missing in the window"


def test_a_channel_that_was_not_recorded() -> None:
    with pytest.raises(BadInputError, match="has no channel"):
        Peak(channel="motor_speed_rad_s").compute(torque(time_axis()), STEP)


def test_windows_run_forward() -> None:
    with pytest.raises(ValueError, match="not after from_s"):
        Peak(channel="shaft_torque_nm", from_s=5.0, to_s=5.0)


@pytest.mark.parametrize(("late_samples", "covered"), [(0.0, True), (0.7, True), (1.4, True), (1.6, False)])
def test_the_window_may_begin_a_sample_and_a_half_before_the_recording(
    late_samples: float, covered: bool
) -> None:
    time = np.asarray(STEP.step_s + 0.001 * (late_samples + np.arange(20_001)), dtype=np.float64)
    if covered:
        assert Peak(channel="shaft_torque_nm", to_s=19.0).compute(torque(time), STEP) == 1.0
    else:
        assert "does not cover" in refusal(torque(time), to_s=19.0)


@pytest.mark.parametrize(("early_samples", "covered"), [(0.0, True), (1.4, True), (1.6, False)])
def test_the_window_may_end_a_sample_and_a_half_after_the_recording(
    early_samples: float, covered: bool
) -> None:
    time = np.asarray(STEP.end_s + 0.001 * (np.arange(-20_000, 1) - early_samples), dtype=np.float64)
    segment = STEP.model_copy(update={"step_s": 4.0})
    if covered:
        assert Peak(channel="shaft_torque_nm").compute(torque(time), segment) == 1.0
    else:
        assert "does not cover" in refusal(torque(time), segment)


@pytest.mark.parametrize(("beyond_samples", "long_enough"), [(1.4, True), (1.6, False), (2.4, False)])
def test_the_segment_may_end_a_sample_and_a_half_before_the_window(
    beyond_samples: float, long_enough: bool
) -> None:
    to_s = 20.0 + 0.001 * beyond_samples
    if long_enough:
        assert Peak(channel="shaft_torque_nm", to_s=to_s).compute(torque(time_axis()), STEP) == 1.0
    else:
        assert "the segment ends 20 s after the step" in refusal(torque(time_axis()), to_s=to_s)


def test_two_samples_are_a_window_and_a_recording() -> None:
    two = Peak(channel="shaft_torque_nm", from_s=1.0, to_s=1.0012)
    time, _ = two.samples(torque(time_axis()), STEP)
    assert list(time) == pytest.approx([4.0, 4.001])
    whole = Segment(id="s", start_s=0.0, step_s=0.0, end_s=0.0012, reference_before=0, reference_after=1)
    assert Peak(channel="shaft_torque_nm").compute(torque(np.array([0.0, 0.001])), whole) == 1.0


def test_a_single_sample_covers_no_window() -> None:
    uneven = torque(np.array([0.0, 0.001, 0.0026, 0.0036, 0.0046]))
    whole = Segment(id="s", start_s=0.0, step_s=0.00155, end_s=0.00275, reference_before=0, reference_after=1)
    assert "does not cover" in refusal(uneven, whole)


def test_the_sample_at_the_end_belongs_to_the_window_or_to_what_follows() -> None:
    for with_end, last in ((True, 23.0), (False, 22.999)):
        time, _ = cut(torque(time_axis()), STEP, "shaft_torque_nm", 3.0, 23.0, with_end=with_end)
        assert time[-1] == pytest.approx(last)
        assert time[0] == pytest.approx(3.0)


def test_uneven_samples_are_laid_on_an_even_grid() -> None:
    time = np.array([2.0, 2.1, 2.5, 2.9, 3.0])
    spacing, values = evenly(time, 10.0 * time - 5.0)
    assert spacing == pytest.approx(0.25)
    assert values == pytest.approx([15.0, 17.5, 20.0, 22.5, 25.0])


def test_the_window_is_told_in_words() -> None:
    whole = Peak(channel="shaft_torque_nm")
    part = Peak(channel="shaft_torque_nm", from_s=1.0, to_s=2.5)
    assert whole.window == "from the step until the end of the segment"
    assert part.window == "from 1 s after the step until 2.5 s after the step"


BACK = STEP.model_copy(  # 300 N m, -150 from 5 s on, 300 from 6 s on
    update={"step_s": 6.0, "first_change_s": 5.0, "reference_before": -150.0, "reference_after": 300.0}
)
TORQUE = np.interp(time_axis(), [5.0, 5.01, 5.2, 6.0, 6.1], [300.0, -400.0, -150.0, -150.0, 300.0])
CHANGES = recording_of(time_axis(), shaft_torque_nm=TORQUE)


def test_a_window_since_the_first_change_holds_every_change_of_torque() -> None:
    assert Magnitude(channel="shaft_torque_nm").compute(CHANGES, BACK) == 300.0
    assert Magnitude(channel="shaft_torque_nm", since="first_change").compute(CHANGES, BACK) == 400.0
    assert PlayCrossings().compute(CHANGES, BACK) == 1
    assert PlayCrossings(since="first_change").compute(CHANGES, BACK) == 2
    firm = 45.0  # a tenth of the step's 450 N m
    there, back = 2 * firm * 0.01 / 700, 2 * firm * 0.1 / 450
    assert TimeInPlay().compute(CHANGES, BACK) == pytest.approx(back, rel=1e-9)
    assert TimeInPlay(since="first_change").compute(CHANGES, BACK) == pytest.approx(there + back, rel=1e-9)
    assert Clunk(since="first_change").compute(CHANGES, BACK) == pytest.approx(70_000.0, rel=1e-9)
    assert Clunk().compute(CHANGES, BACK) == pytest.approx(4_500.0, rel=1e-9)


def test_jerk_and_dose_since_the_first_change_see_what_was_before_the_step() -> None:
    """A push of 2 m/s² half a second long after the first change, and nothing after the step."""
    time = time_axis()
    acceleration = np.where((time >= 5.0) & (time < 5.5), 2.0, 0.0)
    speed = recording_of(time, vehicle_speed_m_s=np.cumsum(acceleration) * 1e-3)
    assert Jerk(since="first_change").compute(speed, BACK) > 100.0
    whole, rest = (
        VibrationDose(since="first_change").compute(speed, BACK),
        VibrationDose().compute(speed, BACK),
    )
    assert whole > 3 * rest
    alone = BACK.model_copy(update={"step_s": 5.0, "first_change_s": None})  # a step where the change is
    assert whole == VibrationDose().compute(speed, alone)
    assert Jerk(since="first_change").compute(speed, BACK) == Jerk().compute(speed, alone)


def test_without_an_earlier_change_the_window_begins_with_the_step() -> None:
    whole = Magnitude(channel="shaft_torque_nm", since="first_change")
    assert whole.compute(CHANGES, BACK.model_copy(update={"first_change_s": None})) == 300.0
    assert "from the first change of torque in the segment until" in whole.definition
    assert "that change left out" in whole.definition


@pytest.mark.parametrize("metric", [Peak, Trough, Overshoot, ResponseTime, SettlingTime, ArrivalShaftTorque])
def test_what_follows_one_step_cannot_begin_before_it(metric: type[Peak]) -> None:
    with pytest.raises(ValueError, match="follows one step in its direction"):
        metric(channel="shaft_torque_nm", since="first_change")


def test_a_window_has_one_begin() -> None:
    with pytest.raises(ValueError, match="both begin the window"):
        Magnitude(channel="shaft_torque_nm", since="first_change", from_s=0.5)
