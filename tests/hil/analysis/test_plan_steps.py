"""From a chirp to a controller on the wire: the shipped commissioning plan, and what can be wrong in one."""

import pytest

from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from test_plans import load_plan
from tests.benches_for_tests import SIM, plan, sim_bench


@pytest.mark.slow
def test_commissioning_finds_the_axle_that_the_bench_was_given_and_tames_it(tmp_path):
    outcome = run_plan(RunRequest(load_plan("commissioning"), sim_bench("commissioning"), tmp_path))
    assert (outcome.error, outcome.result.verdict) == (None, "pass")
    truth = load_model(SIM.simulation.model)
    found = load_model(tmp_path / "physical.toml")
    assert found.kind == "three_inertia"
    for name, value in truth.parameters.items():
        assert found.parameters[name] == pytest.approx(value, rel=0.01), name
    functions = load_model(tmp_path / "model.toml").transfer_functions
    assert functions["motor_speed_rad_s"].delay_s == pytest.approx(0.008, abs=1e-4)
    assert load_controller(tmp_path / "controller_phase.toml").stabilization == "phase"
    recording = read_recording(outcome.recording)
    assert recording.attachments["made/model.toml"] == (tmp_path / "model.toml").read_bytes()
    assert "controller/controller_gain.toml" in recording.attachments


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ("[{set_controller: {designed: x}}]", "no earlier step makes 'controller_x.toml'"),
        ("[{set_controller: {}}]", "either 'file' or 'designed'"),
        ("[{design: {name: x, stabilization: both}}]", "stabilization"),
    ],
)
def test_a_chain_that_cannot_work_is_refused_before_the_bench_is_touched(steps, said, tmp_path):
    with pytest.raises(BadInputError) as caught:
        run_plan(RunRequest(plan(steps), sim_bench("wrong"), tmp_path))
    assert said in str(caught.value)


def test_an_identification_without_excitation_ends_the_run_with_its_reason(tmp_path):
    steps = """
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 0.01, before_s: 1, after_s: 1}
  - identify: {use: [s]}
"""
    outcome = run_plan(RunRequest(plan(steps), sim_bench("idle"), tmp_path))
    assert isinstance(outcome.error, BadInputError)
    assert outcome.result.safe_state == "confirmed"
