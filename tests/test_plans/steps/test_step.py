from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from hil.core.errors import BadInputError
from test_plans import PlannedSegment
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import STEP, step_of


def test_a_step_releases_the_vehicle_and_plays_one_segment() -> None:
    conductor = NoteTaker()
    step = step_of("step", **STEP)
    step.execute(conductor)
    assert conductor.calls == [("release_vehicle",), ("play", "driving_torque", "up")]
    _, samples, segment = conductor.played[0]
    assert_array_equal(samples, np.repeat([0.0, 326.0], [1000, 20_000]))
    assert segment == PlannedSegment("up", "step", 1.0, 0.0, 326.0, "driving_torque", 21.0)
    assert step.segments() == (segment,)
    assert step.duration_s == 21.0


def test_load_speed_keeps_the_dynos_holding() -> None:
    conductor = NoteTaker()
    step_of("step", **STEP, load="speed").execute(conductor)
    assert conductor.calls == [("play", "driving_torque", "up")]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"to_nm": 0}, "that is no step"),
        ({"before_s": -1}, "before_s"),
        ({"after_s": 0}, "after_s"),
        ({"to_nm": 1e6}, "to_nm"),
        ({"load": "brake"}, "load"),
        ({"segment": "a.b"}, "segment"),
        ({"segment": None}, "segment"),
    ],
)
def test_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        step_of("step", **STEP | change)
