from __future__ import annotations

import numpy as np
import pytest

from hil.core.errors import BadInputError
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of

CHIRP = {
    "segment": "sweep",
    "quantity": "motor_torque",
    "from_hz": 0.05,
    "to_hz": 30,
    "duration_s": 60,
    "amplitude_nm": 20,
}


def test_every_sweep_is_a_segment() -> None:
    conductor = NoteTaker()
    chirp = step_of("chirp", **CHIRP, repeats=2)
    chirp.execute(conductor)
    assert conductor.calls == [
        ("release_vehicle",),
        ("play", "motor_torque", "sweep_1"),
        ("play", "motor_torque", "sweep_2"),
    ]
    np.testing.assert_array_equal(conductor.played[0][1], conductor.played[1][1])
    assert chirp.duration_s == 120.0


def test_one_sweep_keeps_its_name_and_has_its_bias_as_reference() -> None:
    (segment,) = step_of("chirp", **CHIRP, bias_nm=25).segments()
    assert (segment.id, segment.kind, segment.step_s, segment.end_s) == ("sweep", "chirp", 0.0, 60.0)
    assert segment.reference_before == segment.reference_after == 25.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"from_hz": 30}, "not below to_hz"),
        ({"from_hz": 0}, "cannot begin at 0 Hz"),
        ({"to_hz": 500}, "less than 500"),
        ({"fade_s": 31}, "does not fit"),
        ({"amplitude_nm": 0}, "amplitude_nm"),
        ({"sweep": "log"}, "sweep"),
        ({"repeats": 0}, "repeats"),
    ],
)
def test_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        step_of("chirp", **CHIRP | change)
