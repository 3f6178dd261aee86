from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from hil.core.errors import BadInputError
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of

RAMP = {"quantity": "motor_torque", "from_nm": 0, "to_nm": 40, "duration_s": 2}


def test_a_ramp_between_two_levels() -> None:
    conductor = NoteTaker()
    ramp = step_of("ramp", **RAMP, segment="slope", before_s=1, after_s=3)
    ramp.execute(conductor)
    _, samples, segment = conductor.played[0]
    assert_allclose(samples[[0, 999, 2000, 3000, -1]], [0, 0, 20, 40, 40])
    assert segment is not None
    assert (segment.kind, segment.step_s, segment.end_s) == ("ramp", 1.0, 6.0)
    assert (segment.reference_before, segment.reference_after) == (0.0, 40.0)
    assert ramp.duration_s == 6.0


def test_without_a_name_there_is_no_segment() -> None:
    conductor = NoteTaker()
    ramp = step_of("ramp", **RAMP)
    ramp.execute(conductor)
    assert ramp.segments() == ()
    assert ramp.numbered(3) == ramp
    assert conductor.calls[-1] == ("play", "motor_torque", None)


def test_refused() -> None:
    with pytest.raises(BadInputError, match="duration_s"):
        step_of("ramp", **RAMP | {"duration_s": 0})
