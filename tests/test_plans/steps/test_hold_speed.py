from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from test_plans import Outlook, Pace
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_speed_goes_to_the_conductor_in_si_units() -> None:
    conductor = NoteTaker()
    step_of("hold_speed", speed_km_h=36, duration_s=2).execute(conductor)
    assert conductor.calls == [("hold_speed", pytest.approx(10.0), 2.0)]


def test_the_estimate_has_the_ramp_in_it() -> None:
    hold = step_of("hold_speed", speed_km_h=36, duration_s=2)
    assert hold.outlook(4.0, Pace(speed_ramp_m_s2=2.0)) == Outlook(5.0, 10.0)
    assert hold.duration_s == pytest.approx(2 + 10 / Pace().speed_ramp_m_s2)


@pytest.mark.parametrize("speed", [401, -101, "20"])
def test_refused(speed: object) -> None:
    with pytest.raises(BadInputError, match=r"speed_km_h: vehicle speed, km/h"):
        step_of("hold_speed", speed_km_h=speed, duration_s=2)
