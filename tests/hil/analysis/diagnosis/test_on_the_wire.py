"""The whole loop: a bench with a hidden effect, its acceptance run, the diagnosis, the mended simulation."""

import pytest

from hil.analysis.diagnosis import diagnose
from hil.core.model import EffectUse, load_model
from hil.core.recording import driven_by_torque, read_recording
from hil.engine import RunRequest, run_plan
from test_plans import load_plan
from tests.benches_for_tests import SIM, sim_bench


@pytest.mark.slow
def test_simulation_and_bench_agree_once_the_hidden_effect_is_named_and_added(tmp_path):
    base = load_model(SIM.simulation.model).with_effects()
    hidden = base.with_parameters(motor_inertia=0.0201, shaft_stiffness=6040.0, vehicle_inertia=304.0)
    hidden = hidden.with_effects(EffectUse("backlash", {"half_gap_rad": 0.02}))

    def accepted(model, name):
        outcome = run_plan(RunRequest(load_plan("acceptance"), sim_bench(name), tmp_path / name, model))
        peaks = {c.id: c.value for c in outcome.result.criteria if c.id.endswith(".peak_shaft_torque")}
        return outcome.recording, peaks

    recording, bench = accepted(hidden, "hidden")
    found = diagnose(base, driven_by_torque(read_recording(recording)))
    assert [effect.use.id for effect in found.effects] == ["backlash"]
    # Steps from rest cross the gap once, from an unknown place in it: a tenth is what they can tell.
    assert found.effects[0].use.values["half_gap_rad"] == pytest.approx(0.02, rel=0.1)
    for name, after in found.gap_after.items():
        assert after.gap < 1.1 * after.noise_floor
        assert after.gap < 0.5 * found.gap_before[name].gap
    _, mended = accepted(found.model, "mended")
    assert mended.keys() == bench.keys()
    for criterion, peak in bench.items():
        assert mended[criterion] == pytest.approx(peak, rel=0.01)
