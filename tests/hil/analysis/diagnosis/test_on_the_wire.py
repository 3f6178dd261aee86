"""The whole loop: a bench with a hidden effect, its acceptance run, the diagnosis, the mended simulation."""

import pytest

from hil.analysis.diagnosis import diagnose
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, load_model
from hil.core.recording import driven_by_torque, read_recording, write_recording
from hil.engine import RunRequest, run_plan
from test_plans import load_plan
from tests.benches_for_tests import SIM, plan, sim_bench

MODEL = load_model(SIM.simulation.model)
# It begins in mid-motion: the third wheel order shakes the axle while the dynos hold its speed
CHIRP = """
  - hold_speed: {speed_km_h: 12, duration_s: 0.3}
  - chirp: {segment: c, quantity: motor_torque, from_hz: 0.5, to_hz: 30, duration_s: 4, amplitude_nm: 20}
"""


@pytest.mark.slow
def test_the_simulated_bench_agrees_with_its_own_model(tmp_path):
    twice = plan(CHIRP + CHIRP.replace("segment: c", "segment: d"))
    outcome = run_plan(RunRequest(twice, sim_bench("own"), tmp_path))
    fitted, held = driven_by_torque(read_recording(outcome.recording))
    found = diagnose(MODEL, [fitted], [held])
    assert found.verdict == "none"
    # what a noise floor read from four seconds may be off by
    for after in (*found.gap_after.values(), *found.holdout_after.values()):
        assert after.gap == pytest.approx(after.noise_floor, rel=0.08)


@pytest.mark.slow
def test_the_identification_plan_agrees_with_its_own_model_in_every_format(tmp_path):
    outcome = run_plan(RunRequest(load_plan("identification"), sim_bench("formats"), tmp_path))
    whole = read_recording(outcome.recording)
    for ending in ("mcap", "csv", "parquet", "mf4"):
        path = tmp_path / f"recording.{ending}"
        if ending != "mcap":
            write_recording(whole, path)
        parts = driven_by_torque(read_recording(path))
        assert len(parts) == 3
        found = diagnose(MODEL, parts)
        assert found.verdict == "none", ending
        for after in found.gap_after.values():
            # 4 % at most at 5 to 20 Hz, where the bench's steps of 0.1 ms and a sample's are not quite alike
            assert after.gap == pytest.approx(after.noise_floor, rel=0.04)


@pytest.mark.parametrize(
    ("effect", "number", "value"),
    [
        # at its end either chirp bounces through it chaotically
        pytest.param("backlash", "half_gap_rad", 0.02, marks=pytest.mark.hunt),
        pytest.param("backlash", "half_gap_rad", 0.01, marks=pytest.mark.slow),
        pytest.param("dead_time", "extra_delay_s", 0.002, marks=pytest.mark.hunt),
        pytest.param("coulomb_friction", "torque_nm", 1.0, marks=pytest.mark.slow),
    ],
)
def test_what_the_bench_hides_is_named_from_the_identification_plan(effect, number, value, tmp_path):
    use = EffectUse(effect, EFFECTS[effect].completed({number: value}))
    hidden = MODEL.with_effects(*MODEL.effects, use)
    outcome = run_plan(RunRequest(load_plan("identification"), sim_bench(effect), tmp_path, hidden))
    found = diagnose(MODEL, driven_by_torque(read_recording(outcome.recording)), at_most_s=300.0)
    assert (found.verdict, found.unfinished) == ("named", "")
    assert [one.use.id for one in found.effects] == [effect]
    # The bench moves in steps of 0.1 ms, a fit in those of a sample: that is more than the noise's error
    assert float(found.effects[0].use.values[number]) == pytest.approx(value, rel=3e-3)
    for channel, after in found.gap_after.items():
        assert after.gap < 0.02 * found.gap_before[channel].gap + 1.1 * after.noise_floor


@pytest.mark.hunt  # three minutes of searching
def test_play_and_dead_time_together_are_named_from_the_identification_plan(tmp_path):
    """Where the play makes motion chaotic it is not judged; the delay is not taken for a lag."""
    play = EffectUse("backlash", EFFECTS["backlash"].completed({"half_gap_rad": 0.01}))
    hidden = MODEL.with_effects(*MODEL.effects, play).with_parameters(torque_delay=0.011)
    outcome = run_plan(RunRequest(load_plan("identification"), sim_bench("both"), tmp_path, hidden))
    found = diagnose(MODEL, driven_by_torque(read_recording(outcome.recording)))
    named = {one.use.id: one.use.values for one in found.effects}
    assert (found.verdict, named.keys()) == ("named", {"backlash", "dead_time"})
    assert float(named["backlash"]["half_gap_rad"]) == pytest.approx(0.01, rel=3e-3)
    assert float(named["dead_time"]["extra_delay_s"]) == pytest.approx(0.003, rel=0.1)


@pytest.mark.slow
@pytest.mark.xfail(
    strict=True, reason="named, 0.0219 rad ± 0.0004: where in the gap it began is not in the error"
)
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
    # Steps from rest cross the gap once. From which place in it nobody can tell: the bench begins in the
    # middle, and so does what is told; that it could be another is in the error.
    half_gap, error = float(found.effects[0].use.values["half_gap_rad"]), found.effects[0].standard_error
    assert half_gap == pytest.approx(0.02, rel=0.1)
    assert abs(half_gap - 0.02) < 2.0 * error["half_gap_rad"]
    for name, after in found.gap_after.items():
        assert after.gap < 1.1 * after.noise_floor
        assert after.gap < 0.5 * found.gap_before[name].gap
    _, mended = accepted(found.model, "mended")
    assert mended.keys() == bench.keys()
    for criterion, peak in bench.items():
        assert mended[criterion] == pytest.approx(peak, rel=0.01)
