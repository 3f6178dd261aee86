from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from test_plans import Pace
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_carried_out_for_its_duration() -> None:
    conductor = NoteTaker()
    step = step_of("ramp_down", duration_s=2.5)
    step.execute(conductor)
    assert conductor.calls == [("ramp_down", 2.5)]
    assert step.duration_s == 2.5
    assert step.outlook(7.0, Pace()).speed_m_s == 0.0


@pytest.mark.parametrize("duration", [-1, 3601, "2", None])
def test_refused(duration: object) -> None:
    with pytest.raises(BadInputError, match="duration_s"):
        step_of("ramp_down", duration_s=duration)
