"""A simulation that diverges is its model's mistake, by name, and no limit, device or fault of ours."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, load_model
from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bench import open_bench
from hil.engine.prediction.prediction import predict
from tests.benches_for_tests import SIM, plan, sim_bench

STEPS = (
    "[{set_controller: {file: phase_stabilization.toml}}, {hold_speed: {speed_km_h: 10, duration_s: 0.2}},"
    " {step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.2, after_s: 0.5}}]"
)


def softening() -> Model:
    """Shafts that give way more and more: nothing of the chain is too stiff, and yet it runs away."""
    effect = EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": -1e9})
    return load_model(SIM.simulation.model).with_effects(effect)


def test_a_run_names_the_model_and_leaves_a_safe_bench_and_its_recording(tmp_path: Path) -> None:
    outcome = run_plan(RunRequest(plan(STEPS), sim_bench("softening"), tmp_path, model=softening()))
    assert isinstance(outcome.error, BadInputError)
    assert outcome.error.where.endswith("three_inertia.toml")
    assert "the simulation diverges" in outcome.error.what
    assert outcome.result.safe_state == "confirmed"
    assert outcome.result.verdict == "error"
    recording = read_recording(outcome.recording, allow_missing=True)
    assert len(recording.time_s) > 100
    assert not any(event.kind == "limit" for event in recording.events)


def test_a_prediction_names_it(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="three_inertia.toml: the simulation diverges"):
        predict(plan(STEPS), sim_bench("predicted"), softening())


def test_a_model_too_stiff_opens_no_bench() -> None:
    model = load_model(SIM.simulation.model).with_parameters(shaft_stiffness=1e9, wheel_inertia=0.01)
    with (
        pytest.raises(BadInputError, match="too fast for the integrator"),
        open_bench(sim_bench("stiff"), model=model),
    ):
        pass
