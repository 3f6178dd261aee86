from __future__ import annotations

import pytest
from numpy.testing import assert_array_equal

from hil.core.errors import BadInputError
from test_plans.steps import Stairs
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_metrics_of_stairs_look_at_the_last_step() -> None:
    conductor = NoteTaker()
    stairs = step_of("stairs", segment="up", quantity="driving_torque", levels_nm=[0, 50, 200], hold_s=4)
    stairs.execute(conductor)
    _, samples, segment = conductor.played[0]
    assert_array_equal(samples[[0, 3999, 4000, 7999, 8000, 11999]], [0, 0, 50, 50, 200, 200])
    assert segment is not None
    assert (segment.step_s, segment.reference_before, segment.reference_after) == (8.0, 50.0, 200.0)
    assert stairs.duration_s == 12.0


@pytest.mark.parametrize("levels", [[], [1], [1, "2"], 3])
def test_refused(levels: object) -> None:
    with pytest.raises(BadInputError, match="levels_nm"):
        step_of("stairs", quantity="driving_torque", levels_nm=levels, hold_s=4)


def test_a_driver_who_changes_their_mind_holds_the_middle_level_shortly() -> None:
    conductor = NoteTaker()
    keys = {"levels_nm": [300, -150, 300], "hold_s": 0.2, "first_s": 2, "last_s": 3}
    stairs = step_of("stairs", segment="back", quantity="driving_torque", **keys)
    stairs.execute(conductor)
    _, samples, segment = conductor.played[0]
    assert_array_equal(samples[[0, 1999, 2000, 2199, 2200, 5199]], [300, 300, -150, -150, 300, 300])
    assert segment is not None
    assert (segment.step_s, segment.end_s) == pytest.approx((2.2, 5.2))
    assert (segment.reference_before, segment.reference_after) == (-150.0, 300.0)
    assert isinstance(stairs, Stairs)
    assert stairs.mean_nm == pytest.approx((300 * 2 - 150 * 0.2 + 300 * 3) / 5.2)


@pytest.mark.parametrize(
    ("levels", "first_change_s"),
    [([300, -150, 300], 2.0), ([0, 0, 50, 0], 2.2), ([0, 50], None), ([0, 0, 50], None), ([5, 5], None)],
)
def test_stairs_know_when_the_torque_first_changes(levels: list[float], first_change_s: float | None) -> None:
    stairs = step_of(
        "stairs", segment="s", quantity="driving_torque", levels_nm=levels, hold_s=0.2, first_s=2, last_s=3
    )
    assert isinstance(stairs, Stairs)
    assert stairs.segments()[0].first_change_s == pytest.approx(first_change_s)
