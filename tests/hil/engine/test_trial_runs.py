"""What a search sees of a plan is what a run over the wire measures."""

import pytest

from hil.core.controller import save_controller
from hil.core.recording import read_recording, run_of
from hil.engine import RunRequest, run_plan
from hil.engine.trial_runs import TrialRuns
from test_plans import Choices, judge, load_plan
from test_plans.loading import LIBRARY
from tests.benches_for_tests import SIM
from tests.hil.analysis.tuning.trials import MODEL, PLAN, trial_of


def test_peak_within_1_percent_and_band_energy_within_3_percent_of_the_wire(tmp_path):
    trial = trial_of()
    tuned = trial.controller({"lead_deg": 20.0, "feed_forward_time_s": 0.06})
    predicted = {c.id: c.value for c in trial.judged(trial.carry_out(MODEL, tuned, 0.0, 0))}
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
    runs = TrialRuns(trial.plan, SIM, trial.driven.file, frozenset({"motor_speed_rad_s"}))
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
    runs = TrialRuns(trial.plan, SIM, LIBRARY / "none.toml", frozenset({"shaft_torque_nm"}))
    assert "motor_speed_rad_s" not in runs(MODEL, None, 0.0, 0).recording
    assert "motor_speed_rad_s" in runs(MODEL, None, 0.0, 0, whole=True).recording
