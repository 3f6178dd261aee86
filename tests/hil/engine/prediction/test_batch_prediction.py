"""What a search sees of a plan is what a run over the wire measures."""

import pytest

from hil.core.controller import save_controller
from hil.core.errors import BadInputError
from hil.core.model import EffectUse
from hil.core.recording import read_recording, run_of
from hil.engine import RunRequest, run_plan
from hil.engine.prediction.batch_prediction import BatchPrediction, _longest_step_s
from test_plans import Choices, judge, load_plan
from test_plans.loading import LIBRARY
from tests.benches_for_tests import SIM
from tests.hil.analysis.tuning.trials import MODEL, PLAN, trial_of


def test_peak_within_1_percent_and_band_energy_within_3_percent_of_the_wire(tmp_path):
    trial = trial_of()
    tuned = trial.controller({"lead_deg": 20.0, "feed_forward_time_s": 0.06})
    predicted = {c.id: c.value for c in trial.judged(trial.execute(MODEL, tuned, 0.0, 0))}
    file = tmp_path / "tuned.toml"
    save_controller(tuned, file)
    (tmp_path / "short.yaml").write_text(PLAN)
    chosen = load_plan(tmp_path / "short.yaml", Choices({"phase_stabilization.toml": file}))
    outcome = run_plan(RunRequest(plan=chosen, bench=SIM, out=tmp_path / "run"))
    assert outcome.error is None
    recording = read_recording(outcome.recording)
    measured = {c.id: c.value for c in judge(chosen, recording, run_of(recording).segments)}
    for name, within in (("phase.peak_shaft_torque", 0.01), ("phase.band_energy", 0.03)):
        assert predicted[name] == pytest.approx(measured[name], rel=within)


def test_noise_is_what_the_bench_file_states_times_a_factor_and_the_same_for_a_seed():
    trial = trial_of()
    runs = BatchPrediction(trial.plan, SIM, trial.driven.file, frozenset({"motor_speed_rad_s"}))
    plain, noisy, again, other = (
        runs(MODEL, None, factor, seed).recording["motor_speed_rad_s"][:150]
        for factor, seed in ((0.0, 1), (1.0, 1), (1.0, 1), (3.0, 2))
    )
    stated = SIM.simulation.noise.motor_speed_rad_s
    assert (noisy - plain).std() == pytest.approx(stated, rel=0.25)
    assert (other - plain).std() == pytest.approx(3 * stated, rel=0.25)
    assert (noisy == again).all()


def test_only_what_is_asked_for_is_recorded_but_a_whole_run_has_everything():
    trial = trial_of()
    runs = BatchPrediction(trial.plan, SIM, LIBRARY / "none.toml", frozenset({"shaft_torque_nm"}))
    assert "motor_speed_rad_s" not in runs(MODEL, None, 0.0, 0).recording
    assert "motor_speed_rad_s" in runs(MODEL, None, 0.0, 0, whole=True).recording


def test_what_comes_before_the_tuned_controller_is_predicted_once_and_changes_nothing():
    trial = trial_of()
    slow, quick = (trial.controller({"feed_forward_time_s": time_s}) for time_s in (0.15, 0.04))
    runs, names = trial.execute, ("shaft_torque_nm", "motor_speed_rad_s")
    kept = [runs(MODEL, controller, 1.0, 7) for controller in (slow, quick, slow)]
    for controller, found in zip((slow, quick, slow), kept, strict=True):
        fresh = BatchPrediction(trial.plan, SIM, trial.driven.file, runs.channels)(MODEL, controller, 1.0, 7)
        assert fresh.segments == found.segments
        assert all((fresh.recording[name] == found.recording[name]).all() for name in names)
    assert (kept[0].recording[names[0]] != kept[1].recording[names[0]]).any()


def test_of_many_cars_the_one_that_was_tried_longest_ago_is_forgotten(monkeypatch):
    monkeypatch.setattr("hil.engine.prediction.batch_prediction._CARS_KEPT", 2)
    trial = trial_of()
    runs = BatchPrediction(trial.plan, SIM, trial.driven.file, frozenset({"motor_speed_rad_s"}))
    for seed in (1, 2, 1, 3):
        runs(MODEL, None, 1.0, seed)
    assert runs._here is not None
    assert [seed for _, _, seed in runs._here.runs_before] == [1, 3]


def test_steps_of_a_sample_give_the_figures_of_steps_as_short_as_the_wires():
    trial = trial_of()
    tuned = trial.controller({"lead_deg": 20.0})
    quick, exact = (trial.judged(trial.execute(MODEL, tuned, 0.0, 0, whole=whole)) for whole in (False, True))
    for one, other in zip(quick, exact, strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-4)


def test_a_model_of_quick_motions_or_with_a_gap_is_not_stepped_a_sample_at_a_time():
    stiff = MODEL.with_parameters(shaft_stiffness=100 * MODEL.parameters["shaft_stiffness"])
    ripple = MODEL.with_effects(EffectUse("motor_order_ripple", {"order": 48.0, "amplitude_nm": 1.0}))
    gap = MODEL.with_effects(EffectUse("backlash", {"half_gap_rad": 0.01}))
    assert [_longest_step_s(one) for one in (MODEL, stiff, ripple, gap)] == [1e-3, 5e-4, 5e-4, 2.5e-4]


def test_a_tried_controller_may_not_ask_for_more_torque_than_the_bench_allows():
    trial = trial_of()
    strong = trial.controller({"torque_limit_nm": 1.01 * SIM.limits.motor_torque_nm})
    with pytest.raises(BadInputError, match="above the bench's"):
        trial.execute(MODEL, strong, 0.0, 0)
