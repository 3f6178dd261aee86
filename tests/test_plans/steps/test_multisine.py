from __future__ import annotations

import numpy as np
import pytest

from hil.core.errors import BadInputError
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of

MULTISINE = {
    "segment": "many",
    "quantity": "motor_torque",
    "seed": 3,
    "from_hz": 0.5,
    "to_hz": 30,
    "period_s": 4,
    "periods": 3,
    "rms_nm": 10,
    "fade_s": 0.5,
}


def test_realisations_have_other_phases_and_segments_of_their_own() -> None:
    conductor = NoteTaker()
    multisine = step_of("multisine", **MULTISINE, realisations=2, odd_only=True)
    multisine.execute(conductor)
    (_, one, first), (_, two, second) = conductor.played
    assert first is not None
    assert second is not None
    assert (first.id, second.id) == ("many_1", "many_2")
    assert (first.step_s, first.end_s) == (0.5, 13.0)
    assert len(one) == len(two) == 13_000
    assert not np.allclose(one, two)
    period = one[500:4500]
    assert np.sqrt(np.mean(period**2)) == pytest.approx(10.0)
    np.testing.assert_array_equal(period, one[4500:8500])
    assert multisine.duration_s == 26.0


def test_the_second_realisation_is_the_first_of_the_next_seed() -> None:
    conductor = NoteTaker()
    step_of("multisine", **MULTISINE, realisations=2).execute(conductor)
    step_of("multisine", **MULTISINE | {"seed": 4}).execute(conductor)
    np.testing.assert_array_equal(conductor.played[1][1], conductor.played[2][1])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"amplitude_nm": 5}, "give either"),
        ({"rms_nm": None}, "give either"),
        ({"from_hz": 40}, "not below to_hz"),
        ({"to_hz": 501}, "less than 500"),
        ({"period_s": 0.1005}, "milliseconds"),
        ({"from_hz": 0.51, "to_hz": 0.6}, "no line"),
        ({"periods": 1000}, "at most 3600"),
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
    ],
)
def test_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        step_of("multisine", **MULTISINE | change)
