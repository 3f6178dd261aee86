"""The shipped plans on slippery roads: their limits bind, and a panel that has no road says so."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.controller import load_controller
from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.engine import load_bench
from hil.engine.prediction.prediction import predict
from hil.engine.run.preflight import preflight
from test_plans import judge, load_plan
from test_plans.loading import LIBRARY
from tests.benches_for_tests import plan

BENCHES = Path(__file__).parents[4] / "benches"
BENCH, MODEL = load_bench(BENCHES / "sim_road.toml"), load_model(BENCHES / "road_axle.toml")
SLIP, LEAD = (LIBRARY / "controllers" / f"{name}.toml" for name in ("slip_limit", "phase_stabilization"))


@pytest.mark.parametrize("name", ["take_off_on_low_friction", "split_friction"])
def test_each_limit_lies_a_quarter_beyond_and_the_lead_alone_slips_too_much(name: str) -> None:
    asked = load_plan(name)
    found = predict(asked, BENCH, MODEL)
    for one in judge(asked, found.recording, found.segments, measured=False, device=False):
        assert one.value is not None
        assert one.upper == pytest.approx(1.25 * one.value, rel=0.01), one.id
    tried = predict(asked, BENCH, MODEL, controllers={SLIP: load_controller(LEAD)})
    results = judge(asked, tried.recording, tried.segments, measured=False, device=False)
    failed = {one.id for one in results if one.verdict == "fail"}
    on_ice = {one.id for one in results if "ice.slip_left" in one.id or "ice.wheel_slip" in one.id}
    assert failed == on_ice


def test_segments_know_their_road() -> None:
    found = predict(load_plan("take_off_on_low_friction"), BENCH, MODEL)
    assert {one.id: (one.friction, one.slippery) for one in found.segments} == {
        "take_off_dry": (1.0, False),
        "take_off_ice": (0.05, True),
        "tip_in_ice": (0.05, True),
        "regeneration_ice": (0.05, True),
        "tip_in_dry": (1.0, False),
    }


def test_a_model_whose_tyres_hold_everywhere_has_no_friction_to_set() -> None:
    with pytest.raises(BenchError, match="refuses a friction"):
        predict(plan("[{set_vehicle: {friction: 0.1}}]"), BENCH, load_model(BENCHES / "three_inertia.toml"))


def test_a_run_is_refused_before_it_begins_where_no_tyre_can_slide(tmp_path: Path) -> None:
    icy = plan("[{set_vehicle: {friction: 0.1}}]")
    preflight(icy, BENCH, tmp_path)
    with pytest.raises(BadInputError, match="hold whatever the road is"):
        preflight(icy, BENCH, tmp_path, model=load_model(BENCHES / "three_inertia.toml"))
