"""A row is what its number says: the same whoever makes it, after whichever others."""

import math

import pytest

from hil.analysis.tuning import draws_of, with_values
from hil.campaign import Simulations, load_setting
from hil.core.controller import load_controller
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.engine.prediction.prediction import predict
from test_plans import judge
from tests.docs.documented import blocks_of
from tests.hil.campaign.short import CAMPAIGN, written

OWN = "name: own\nplan: short.yaml\n"


def without_time(row):
    return {name: value for name, value in row.items() if name != "processor_s"}


def test_a_row_is_the_run_that_its_number_says(tmp_path):
    setting = load_setting(written(tmp_path))
    assert len(setting.cases) == 16
    simulations = Simulations(setting)
    row = simulations.row(13)
    assert row["controller"] == "phase_stabilization"
    assert (row["draw"], row["model.vehicle_inertia"], row["controller.feed_forward_time_s"]) == (
        2,
        350,
        0.15,
    )
    assert setting.replaced is not None
    model = setting.model.with_parameters(vehicle_inertia=350.0)
    car = draws_of(model, setting.file.tolerance, 2, 3)[2]
    assert row["model.tyre_stiffness"] == car.model.parameters["tyre_stiffness"] != 5000
    tried = with_values(load_controller(setting.replaced), {"feed_forward_time_s": 0.15})
    found = predict(setting.plan, setting.bench, car.model, controllers={setting.replaced: tried})
    values = {one.id: one.value for one in judge(setting.plan, found.recording, found.segments)}
    # without noise, and with another step of the integrator
    assert row["value.phase.peak_shaft_torque"] == pytest.approx(values["phase.peak_shaft_torque"], rel=0.02)


def test_the_order_in_which_rows_are_made_changes_nothing(tmp_path):
    setting = load_setting(written(tmp_path))
    simulations = Simulations(setting)
    forth = [without_time(simulations.row(number)) for number in range(16)]
    other = Simulations(setting)
    back = [without_time(other.row(number)) for number in reversed(range(16))]
    assert forth == list(reversed(back))
    assert len({row["value.phase.peak_shaft_torque"] for row in forth}) == 16


def test_variables_of_the_plan_and_effects_are_varied(tmp_path):
    text = OWN + "vary: {plan.torque_nm: [100, 200], effect.backlash.half_gap_rad: [0.001, 0.03]}"
    file = written(tmp_path, text)
    plan = (tmp_path / "short.yaml").read_text().replace("to_nm: 326", "to_nm: $torque_nm")
    (tmp_path / "short.yaml").write_text(plan + "variables: {torque_nm: {default: 326, unit: N m}}\n")
    simulations = Simulations(load_setting(file))
    peaks = [simulations.row(number)["value.gain.peak_shaft_torque"] for number in range(4)]
    assert max(peaks[:2]) < min(peaks[2:])
    assert len(set(peaks)) == 4


def test_an_effect_that_is_varied_may_be_what_differs(tmp_path):
    numbers = "".join(
        f"  effect.wheel_order_disturbance.{p.name}: [{max(p.lower, min(1.0, p.upper))}]\n"
        for p in EFFECTS["wheel_order_disturbance"].parameters
    )
    text = OWN + f"draws: 2\ntolerance: {{order_phase: true}}\nvary:\n{numbers}"
    assert len(load_setting(written(tmp_path, text)).cases) == 2


def test_a_simulation_that_fails_is_a_row(tmp_path, monkeypatch):
    simulations = Simulations(load_setting(written(tmp_path, OWN)))

    def refused(*_, **__):
        raise BadInputError("no such axle")

    monkeypatch.setattr("hil.engine.prediction.batch_prediction.BatchPrediction.__call__", refused)
    row = simulations.row(0)
    assert (row["verdict"], row["error"], row["draw"]) == ("error", "no such axle", 0)
    assert math.isfinite(row["processor_s"])


def test_the_example_of_the_page_is_a_campaign(tmp_path):
    (tmp_path / "page.yaml").write_text(blocks_of("docs/how-to/campaigns.md", "yaml")[0])
    setting = load_setting(tmp_path / "page.yaml")
    assert len(setting.cases) == 120
    assert Simulations(setting).row(119)["error"] is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (OWN + "model: there.toml", "there is no file 'there.toml'"),
        (OWN + "controllers: [gain_stabilization, gain_stabilization]", "stands twice"),
        (OWN + "controllers: [gain_stabilisation]", "did you mean 'gain_stabilization'?"),
        (OWN + "controller: fase_stabilization", "did you mean 'phase_stabilization'?"),
        (OWN + "criteria: [gain.peak]", "has no criterion 'gain.peak'"),
        (OWN + "criteria: [phase.overshoot_shaft_torque]", "no simulation can be judged"),
        (
            OWN + "draws: 1000000\nvary: {controller.lead_deg: [1, 2]}",
            "2000000 simulations (1000000 cars × 2 values",
        ),
        (OWN + "draws: 5", "line 3, key 'draws': 5 vehicles are to be sampled, but no parameter varies"),
        (OWN + "draws: 5\ntolerance: {vehicle_inertia: 0}", "no parameter varies"),
        (OWN + "draws: 5\ntolerance:\n  viscous_drag: 0.1", "line 5, key 'tolerance.viscous_drag'"),
        ("name: own\nplan: identification", "no simulation can be judged"),
        ("name: own\nplan: nowhere", "there is no plan 'nowhere'"),
        (CAMPAIGN + "bench: nowhere", "nowhere"),
    ],
)
def test_what_does_not_fit_is_told(tmp_path, text, said):
    with pytest.raises(BadInputError) as error:
        load_setting(written(tmp_path, text))
    assert said in str(error.value)
