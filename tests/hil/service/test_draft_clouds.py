"""Drafts on drawn cars, and in the segments of a plan, over the API of the real service."""

from __future__ import annotations

import pytest

from hil.api_schemas.design import CloudWanted, DraftWanted, SegmentsWanted
from hil.client import Client, RefusedError
from tests.hil.service.served import Served


@pytest.fixture
def client(service: Served) -> Client:
    return Client(service.url)


@pytest.mark.slow
def test_the_first_car_is_the_model_and_the_worst_is_marked(client: Client) -> None:
    found = client.draft_cloud(CloudWanted(model="three_inertia", cars=8))
    nominal = client.draft(DraftWanted(model="three_inertia"))
    assert len(found.cars) == len(found.loops) == 9
    assert found.source.startswith("8 cars: vehicle_inertia ±0.1")
    first, worst = found.cars[0], found.cars[found.worst]
    assert first.differs == {}
    assert first.margins.sensitivity_peak == pytest.approx(nominal.margins.sensitivity_peak, rel=1e-3)
    assert first.overshoot_nm == pytest.approx(
        [step.overshoot_shaft_torque_nm for step in nominal.steps], rel=1e-6
    )
    peaks = [car.margins.sensitivity_peak or 0.0 for car in found.cars]
    assert worst.margins.sensitivity_peak == max(peaks) > peaks[0]
    assert worst.differs.keys() >= {"vehicle_inertia", "torque_delay"}
    assert all((car.band_energy or 0) > 0 for car in found.cars)
    upper = [one or 0.0 for one in found.sensitivity_upper]
    assert all(
        low <= one + 1e-9 <= high + 2e-9  # type: ignore[operator]
        for low, one, high in zip(found.sensitivity_lower, found.worst_sensitivity, upper, strict=True)
    )


@pytest.mark.slow
def test_a_wider_tolerance_gives_a_worse_worst_car(client: Client) -> None:
    def peak(late_s: float) -> float:
        wanted = CloudWanted(model="three_inertia", cars=8, tolerance={"dead_time_s": late_s})
        found = client.draft_cloud(wanted)
        return found.cars[found.worst].margins.sensitivity_peak or 0.0

    assert peak(0.004) > peak(0.001) > peak(0.0)


@pytest.mark.slow
def test_cars_of_functions_have_margins_and_no_steps(client: Client) -> None:
    found = client.draft_cloud(CloudWanted(model="paper_functions", cars=3))
    assert len(found.cars) == 4
    assert found.cars[0].overshoot_nm == [None, None]
    assert "no inertias" in found.steps_why_not


@pytest.mark.slow
def test_every_segment_has_the_margins_of_its_own_controller_and_of_the_draft(client: Client) -> None:
    found = client.draft_segments(SegmentsWanted(model="three_inertia", cars=4, plan="acceptance"))
    rows = {row.segment: row for row in found.segments}
    assert rows["phase_20kmh"].speed_km_h == 20
    assert rows["gain_0kmh"].controller == "gain_stabilization"
    assert rows["gain_0kmh"].own != rows["phase_0kmh"].own
    assert rows["gain_0kmh"].draft == rows["phase_20kmh"].draft
    worst = rows["phase_0kmh"].own.worst.sensitivity_peak
    assert (worst or 0) > (rows["phase_0kmh"].own.margins.sensitivity_peak or 0)


@pytest.mark.slow
def test_on_ice_tyres_grip_and_slide(client: Client) -> None:
    wanted = SegmentsWanted(model="three_inertia", cars=2, plan="take_off_on_low_friction")
    found = client.draft_segments(wanted)
    ice = [row for row in found.segments if row.segment == "take_off_ice"]
    assert [(row.friction, row.sliding) for row in ice] == [(0.05, False), (0.05, True)]
    assert ice[0].own != ice[1].own
    dry = [row for row in found.segments if row.segment == "take_off_dry"]
    assert [row.sliding for row in dry] == [False]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"tolerance": {"vehicle_inertia": 0.1, "nonsense": 0.1}}, "nonsense"),
        ({"tolerance": {"dead_time_s": -1.0}}, "dead_time_s"),
        ({"model": "paper_functions", "tolerance": {"vehicle_inertia": 0.1}}, "no parameters"),
    ],
)
def test_a_tolerance_that_cannot_be_is_refused(client: Client, wrong: dict[str, object], said: str) -> None:
    with pytest.raises(RefusedError) as refused:
        client.draft_cloud(CloudWanted.model_validate({"model": "three_inertia", "cars": 2, **wrong}))
    assert said in str(refused.value)
