from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from test_plans import Outlook, Pace
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_slip_goes_to_the_conductor_as_a_share() -> None:
    conductor = NoteTaker()
    step = step_of("set_slip", slip_percent=5)
    step.execute(conductor)
    assert conductor.calls == [("set_slip", pytest.approx(0.05))]
    assert step.outlook(4.0, Pace()) == Outlook(0.0, 4.0)


@pytest.mark.parametrize("percent", [-1, 51, "5"])
def test_refused(percent: object) -> None:
    with pytest.raises(BadInputError, match="slip_percent"):
        step_of("set_slip", slip_percent=percent)
