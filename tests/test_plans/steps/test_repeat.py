from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from test_plans import Outlook, Pace
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import STEP, step_of


def test_segments_are_numbered_by_pass_from_outside_in() -> None:
    inner = {"repeat": {"times": 2, "steps": [{"step": STEP}]}}
    repeat = step_of("repeat", times=2, steps=[inner, {"wait": {"duration_s": 1}}])
    assert [segment.id for segment in repeat.segments()] == ["up_1_1", "up_1_2", "up_2_1", "up_2_2"]
    conductor = NoteTaker()
    repeat.execute(conductor)
    assert [segment.id for _, _, segment in conductor.played if segment] == [
        segment.id for segment in repeat.segments()
    ]
    assert conductor.calls.count(("wait", 1.0)) == 2
    assert repeat.count == 6


def test_the_estimate_takes_speed_from_pass_to_pass() -> None:
    hold = [{"hold_speed": {"speed_km_h": v, "duration_s": 0}} for v in (36, 0)]
    repeat = step_of("repeat", times=3, steps=hold)
    assert repeat.outlook(5.0, Pace(speed_ramp_m_s2=1.0)) == Outlook(5 + 10 + 4 * 10, 0.0)


@pytest.mark.parametrize(("times", "says"), [(0, "times"), (1.5, "times"), (101, "10100 steps in total")])
def test_refused(times: float, says: str) -> None:
    inner = {"repeat": {"times": 100, "steps": [{"wait": {"duration_s": 0}}]}}
    with pytest.raises(BadInputError, match=says):
        step_of("repeat", times=times, steps=[inner])


def test_a_repeat_of_nothing_is_refused() -> None:
    with pytest.raises(BadInputError, match="steps"):
        step_of("repeat", times=2, steps=[])
