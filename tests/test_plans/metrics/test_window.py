from __future__ import annotations

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans import Array
from test_plans.metrics import NoValueError, Peak
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
