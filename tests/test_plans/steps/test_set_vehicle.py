from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from hil.core.vehicle import VehicleAndRoad
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_what_is_given_goes_to_the_conductor_and_the_rest_stays() -> None:
    conductor = NoteTaker()
    step_of("set_vehicle", mass_kg=1500, slip_percent=5).execute(conductor)
    assert conductor.calls == [("set_vehicle", VehicleAndRoad(mass_kg=1500, slip=0.05))]


@pytest.mark.parametrize(
    ("keys", "sides"),
    [
        ({"friction": 0.1}, (0.1, 0.1)),
        ({"friction_left": 0.1}, (0.1, None)),
        ({"friction_left": 0.1, "friction_right": 1.0}, (0.1, 1.0)),
    ],
)
def test_friction_is_that_of_both_sides_or_of_each(keys: dict[str, float], sides: tuple[float, ...]) -> None:
    conductor = NoteTaker()
    step_of("set_vehicle", **keys).execute(conductor)
    left, right = sides
    assert conductor.calls == [("set_vehicle", VehicleAndRoad(friction_left=left, friction_right=right))]


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"mass_kg": 0},
        {"mass_kg": "1500"},
        {"f0_n": -1},
        {"slip_percent": 60},
        {"friction": 0.0},
        {"friction": 5.0},
        {"friction_right": 1.1},
        {"friction": 1.0, "friction_left": 0.1},
    ],
)
def test_refused(keys: dict[str, object]) -> None:
    with pytest.raises(BadInputError):
        step_of("set_vehicle", **keys)


def test_at_the_wheels() -> None:
    found = VehicleAndRoad(mass_kg=1000, f0_n=10, f1_ns_m=3, f2_ns2_m2=0.5).at_wheels(0.3)
    assert found == pytest.approx({"inertia_kg_m2": 90.0, "rolling_nm": 3.0, "aero_nms2_rad2": 0.0135})


def test_a_friction_is_a_share_and_no_coefficient() -> None:
    with pytest.raises(BadInputError) as refused:
        step_of("set_vehicle", friction=5.0)
    assert "must be at most 1" in refused.value.what
    assert refused.value.fix == "friction: of the road, as a share of a dry one's: 1 is dry, 0.05 ice"
