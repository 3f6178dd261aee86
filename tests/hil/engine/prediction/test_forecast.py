"""A prediction is held against a run of the same plan on the simulated bench, through its frames.

Both are of one compiled tick, so a channel may differ by one count of its signal at most: where the last
bits of a number lie at the border between two counts. Sensors have no noise in these runs.
"""

import dataclasses
import json

import numpy as np
import pytest

from hil.core.controller import load_controller, save_controller
from hil.core.controller.shaping import RequestLimits, Schedule, SlipWithdrawal
from hil.core.errors import BadInputError, BenchError
from hil.core.model import EffectUse, load_model, model_from_dict
from hil.core.recording import read_recording, run_of, write_recording
from hil.engine import RunRequest, load_bench, run_plan
from hil.engine.bench.bench_tables import NoiseTable
from hil.engine.bench.ranges import limits_of_channels
from hil.engine.prediction._predicted_bench import PredictedBench
from hil.engine.prediction._predicted_wire import wire_of
from hil.engine.prediction.forecast import forecast
from hil.engine.prediction.prediction import predict
from test_plans import Outlook, Step, judge, load_plan
from test_plans.loading import LIBRARY
from tests.benches_for_tests import SIM, plan, sim_bench

SILENT = NoiseTable(motor_speed_rad_s=0.0, wheel_speed_rad_s=0.0, shaft_torque_nm=0.0)
SIMULATION = SIM.simulation.model_copy(update={"noise": SILENT})
MODEL = load_model(SIM.simulation.model)
# One count of each channel's signal in the DBC and the EDS; sums of both sides have a count of each
RESOLUTION = {name: signal.scale for name, signal in wire_of(SIM).rounding.channels.items()}
RESOLUTION |= {
    "wheel_speed_rad_s": RESOLUTION["wheel_speed_left_rad_s"],
    "shaft_torque_nm": 2 * RESOLUTION["shaft_torque_left_nm"],
    "dyno_torque_ref_nm": 2 * RESOLUTION["dyno_torque_left_nm"],
}

# The acceptance plan, shortened: both controllers, both kinds of start
STEPS = """
  - set_controller: {file: gain_stabilization.toml}
  - hold_speed: {speed_km_h: 0, duration_s: 0.1}
  - step: {segment: gain, quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.1, after_s: 0.7}
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 5, duration_s: 0.1}
  - step: {segment: phase, quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.1, after_s: 0.7}
"""
CHIRPS = """
  - hold_speed: {speed_km_h: 3, duration_s: 0.1}
  - chirp: {segment: c, quantity: motor_torque, from_hz: 1, to_hz: 60, duration_s: 0.537, amplitude_nm: 20,
            fade_s: 0.1, repeats: 2}
  - chirp: {segment: held, quantity: motor_torque, load: speed, from_hz: 1, to_hz: 30, duration_s: 0.5,
            amplitude_nm: 20, bias_nm: 5, fade_s: 0.1}
"""
COAST_AND_STAIRS = """
  - hold_speed: {speed_km_h: 4, duration_s: 0}
  - stairs: {segment: st, quantity: motor_torque, levels_nm: [0, 20, -10, 3], hold_s: 0.203}
  - coast: {duration_s: 0.4}
  - wait: {duration_s: 0.123}
  - operator_prompt: {text: look at it}
  - coast: {duration_s: 0.1}
"""
REPEAT = """
  - set_controller: {file: phase_stabilization.toml}
  - repeat:
      times: 2
      steps:
        - hold_speed: {speed_km_h: 4, duration_s: 0.1}
        - ramp: {segment: r, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.1,
                 duration_s: 0.2, after_s: 0.1}
        - hold_speed: {speed_km_h: -2, duration_s: 0.1}
        - multisine: {segment: m, quantity: motor_torque, seed: 3, from_hz: 5, to_hz: 50, period_s: 0.2,
                      periods: 1, rms_nm: 5, fade_s: 0}
"""
SLIP = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 5, duration_s: 0.1}
  - set_slip: {slip_percent: 10}
  - step: {segment: slipping, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.1, after_s: 0.4}
  - set_slip: {slip_percent: 2.5}
  - coast: {duration_s: 0.2}
"""
TWO_INERTIA = {
    "kind": "two_inertia",
    "parameters": {
        "motor_inertia": 0.02,
        "gear_ratio": 8.148,
        "shaft_stiffness": 6089.0,
        "shaft_damping": 19.75,
        "vehicle_inertia": 307.0,
        "torque_delay": 0.0083,
    },
    "effects": [
        {"id": "backlash", "half_gap_rad": 0.01},
        {"id": "coulomb_friction", "torque_nm": 1.0},
        {"id": "running_resistance", "rolling_nm": 10.0, "aero_nms2_rad2": 0.05},
        {"id": "sensor_gain", "channel": "motor_speed_rad_s", "gain": 1.01},
        {"id": "sensor_offset", "channel": "shaft_torque_nm", "offset": 3.0},
        {"id": "channel_skew", "channel": "wheel_speed_rad_s", "delay_s": 0.0025},
        {"id": "sensor_quantization", "channel": "shaft_torque_nm", "step": 0.5},
    ],
}
RIGID = {
    "kind": "rigid",
    "parameters": {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "vehicle_inertia": 307.0,
        "viscous_drag": 0.01,
        "torque_delay": 0.004,
    },
}


def both(directory, checked, model=MODEL, **changes):
    """The outcome of a run with its recording, and the prediction."""
    bench = sim_bench("forecast", **{"simulation": SIMULATION, **changes})
    outcome = run_plan(RunRequest(checked, bench, directory, model=model))
    assert outcome.error is None
    return outcome, read_recording(outcome.recording), predict(checked, bench, model)


def assert_equal(outcome, recorded, predicted):
    assert predicted.segments == outcome.result.segments
    assert set(predicted.recording.channels) == set(recorded.channels)
    np.testing.assert_array_equal(predicted.recording.time_s, recorded.time_s)
    for name, resolution in RESOLUTION.items():
        difference = np.max(np.abs(predicted.recording[name] - recorded[name]))
        assert difference <= 1.001 * resolution, name
    for name, value in outcome.largest.items():
        assert predicted.peaks[name] == pytest.approx(value, abs=1.001 * RESOLUTION[name])


@pytest.mark.parametrize("steps", [STEPS, CHIRPS, COAST_AND_STAIRS, REPEAT, SLIP])
def test_a_prediction_is_the_run_without_its_wire(tmp_path, steps):
    outcome, recorded, predicted = both(tmp_path, plan(steps))
    assert_equal(outcome, recorded, predicted)
    kinds = [event.kind for event in recorded.events if event.kind in ("segment", "speed", "controller")]
    assert [e.kind for e in predicted.recording.events if e.kind in set(kinds)] == kinds


def test_what_goes_beyond_fig_3_acts_on_the_wire_and_in_a_prediction_alike(tmp_path):
    """All four tables, through play, and then a controller without them."""
    crossing = load_controller(LIBRARY / "controllers" / "play_crossing.toml")
    tables = {
        "request": RequestLimits(rise_nm_s=20_000.0, fall_nm_s=30_000.0),
        "slip": SlipWithdrawal(allowed=0.2, recovery_nm_s=30_000.0),
        "schedule": Schedule(speed_m_s=(0.0, 2.0), wsc_factor=(1.0, 0.8), dfc_factor=(1.0, 1.5)),
    }
    mine = tmp_path / "mine.toml"
    save_controller(crossing.model_copy(update=tables), mine)
    steps = "".join(
        f"""
  - set_controller: {{file: {file}}}
  - hold_speed: {{speed_km_h: 5, duration_s: 0.1}}
  - stairs: {{segment: {name}, quantity: driving_torque, levels_nm: [0, 200, -100, 200], hold_s: 0.15}}
"""
        for name, file in (("with", mine), ("without", "phase_stabilization.toml"))
    )
    gap = EffectUse("backlash", {"half_gap_rad": 0.02})
    outcome, recorded, predicted = both(
        tmp_path / "run", plan(steps), MODEL.with_effects(*MODEL.effects, gap)
    )
    assert_equal(outcome, recorded, predicted)


@pytest.mark.parametrize("model", [TWO_INERTIA, RIGID])
def test_other_axles_and_their_sensors_are_predicted(tmp_path, model):
    outcome, recorded, predicted = both(tmp_path, plan(CHIRPS), model_from_dict(model, "test model"))
    assert np.ptp(recorded["motor_speed_rad_s"]) > 20.0
    assert_equal(outcome, recorded, predicted)


def test_the_bench_files_vehicle_and_its_ramp_are_predicted(tmp_path):
    vehicle = SIM.vehicle.model_copy(
        update={"wheel_radius_m": 0.31, "slip": 0.05, "inertia_kg_m2": 150.1, "rolling_nm": 20.0}
    )
    dyno = SIM.dyno.model_copy(update={"speed_ramp_m_s2": 3.3})
    assert_equal(*both(tmp_path, plan(STEPS), vehicle=vehicle, dyno=dyno))


def test_frames_of_slow_buses_are_recorded_where_their_times_put_them(tmp_path):
    rates = {"rmcu": 1_000_000, "dyno": 620_000}
    buses = {
        name: bus.model_copy(update={"bit_rate": rates[name], "channel": f"forecast/{name}"})
        for name, bus in SIM.buses.items()
    }
    outcome, recorded, predicted = both(tmp_path, plan(CHIRPS), buses=buses)
    left, right = (recorded[f"dyno_torque_{side}_nm"] for side in ("left", "right"))
    assert np.max(np.abs(left - right)) > 1.0  # the right one's frame is nearer to the next sample's stamp
    assert_equal(outcome, recorded, predicted)


@pytest.mark.slow
def test_the_acceptance_plan_is_predicted_with_its_criteria(tmp_path):
    checked = load_plan("acceptance")
    outcome, recorded, predicted = both(tmp_path, checked)
    assert_equal(outcome, recorded, predicted)
    criteria = judge(checked, predicted.recording, predicted.segments)
    assert len([one for one in criteria if one.source == "plan"]) == 20
    for found, run in zip(criteria, outcome.result.criteria, strict=True):
        assert (found.id, found.verdict) == (run.id, run.verdict)
        if run.value is not None:
            assert found.value == pytest.approx(run.value, rel=1e-3)


def test_parameters_that_the_rmcu_keeps_act_on_the_wire_and_in_a_prediction_alike(tmp_path):
    held = SIMULATION.model_copy(update={"rmcu": {"k_i_dfc": 0.02, "sigma": 4.0}})
    outcome, recorded, predicted = both(tmp_path, plan(STEPS), simulation=held)
    assert_equal(outcome, recorded, predicted)
    usual = predict(plan(STEPS), sim_bench("forecast", simulation=SIMULATION), MODEL)
    assert predicted.peaks["shaft_torque_left_nm"] > 1.02 * usual.peaks["shaft_torque_left_nm"]


def test_noise_changes_peaks_by_little(tmp_path):
    bench = sim_bench("forecast")
    outcome = run_plan(RunRequest(plan(STEPS), bench, tmp_path))
    predicted = predict(plan(STEPS), bench, MODEL)
    noise = bench.simulation.noise
    for name, deviation in (
        ("motor_speed_rad_s", noise.motor_speed_rad_s),
        ("shaft_torque_left_nm", noise.shaft_torque_nm),
    ):
        assert predicted.peaks[name] == pytest.approx(outcome.largest[name], abs=10 * deviation)


class Look(Step):
    """An analysis that keeps what it was shown."""

    kind = "look"

    def execute(self, conductor):
        conductor.analyse("look", self._work, ("seen.csv",))

    def outlook(self, speed_m_s, pace):
        return Outlook(0.0, speed_m_s)

    def _work(self, recording, made):
        run = run_of(recording)
        write_recording(recording, made / "seen.csv")
        return {
            "seen.csv": (made / "seen.csv").read_bytes(),
            "segments.json": json.dumps([segment.id for segment in run.segments]).encode(),
        }


def test_an_analysis_is_shown_what_it_would_be_shown_in_a_run(tmp_path):
    chirp = plan(CHIRPS)
    checked = chirp.model_copy(update={"steps": (*chirp.steps, Look(), chirp.steps[0])})
    _, _, predicted = both(tmp_path, checked)
    assert json.loads(predicted.made["segments.json"]) == ["c_1", "c_2", "held"]
    assert predicted.made["segments.json"] == (tmp_path / "segments.json").read_bytes()
    (tmp_path / "predicted.csv").write_bytes(predicted.made["seen.csv"])
    seen, run = read_recording(tmp_path / "predicted.csv"), read_recording(tmp_path / "seen.csv")
    np.testing.assert_array_equal(seen.time_s, run.time_s)
    for name, resolution in RESOLUTION.items():
        assert np.max(np.abs(seen[name] - run[name])) <= 1.001 * resolution


@pytest.mark.slow
def test_a_controller_that_the_plan_designs_is_used(tmp_path):
    steps = """
  - hold_speed: {speed_km_h: 10, duration_s: 0.1}
  - chirp: {segment: c, quantity: motor_torque, from_hz: 0.2, to_hz: 30, duration_s: 20, amplitude_nm: 20}
  - identify: {}
  - design: {name: lead, stabilization: phase}
  - set_controller: {designed: lead}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.1, after_s: 0.5}
"""
    predicted = predict(plan(steps), sim_bench("forecast"), MODEL)
    assert {"model.toml", "controller_lead.toml"} <= set(predicted.made)
    step = predicted.segments[-1]
    assert step.controller == "phase"
    inside = predicted.recording.between(step.step_s, step.end_s)
    assert np.max(inside["shaft_torque_nm"]) == pytest.approx(100.0, rel=0.5)


def test_a_forecast_has_peaks_with_limits_and_criteria_with_verdicts():
    criteria = """
  - {segment: gain, metric: peak_shaft_torque, upper: 100, unit: N m}
  - {segment: phase, metric: peak_shaft_torque, upper: 1000, unit: N m}
"""
    found = forecast(plan(STEPS, criteria), SIM)
    assert {name: limit for name, (_, limit) in found.peaks.items()} == limits_of_channels(SIM.limits)
    assert [criterion.verdict for criterion in found.criteria] == ["fail", "pass"]
    assert found.fits
    low = SIM.model_copy(update={"limits": SIM.limits.model_copy(update={"shaft_torque_nm": 100.0})})
    assert not forecast(plan(STEPS), low).fits


def test_a_bench_with_hardware_is_predicted_with_the_shipped_model():
    hardware = load_bench("rear_axle_socketcan")
    assert hardware.simulation is None
    found = forecast(plan(STEPS), hardware)
    assert found.peaks["shaft_torque_left_nm"][0] > 163.0


def test_what_the_bench_does_not_allow_is_refused_as_in_a_run():
    steps = (
        "[{step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 151, before_s: 0.1, after_s: 0.1}}]"
    )
    with pytest.raises(BadInputError, match="the bench allows 150 N m"):
        forecast(plan(steps), SIM)


def test_a_dbc_without_a_number_for_a_parameter_is_refused(tmp_path):
    text = SIM.rmcu.dbc.read_text("utf-8").replace('8 "k_p"', '8 "gain"')
    (tmp_path / "rmcu.dbc").write_text(text)
    rmcu = SIM.rmcu.model_copy(update={"dbc": tmp_path / "rmcu.dbc"})
    with pytest.raises(BadInputError, match="no parameter named 'k_p'"):
        forecast(plan(STEPS), SIM.model_copy(update={"rmcu": rmcu}))


def test_a_model_without_a_shaft_is_refused():
    simulation = SIM.simulation.model_copy(update={"model": SIM.source.parent / "paper_functions.toml"})
    with pytest.raises(BadInputError, match="cannot be a simulated bench"):
        forecast(plan(CHIRPS), SIM.model_copy(update={"simulation": simulation}))


def test_wheels_that_the_dynos_cannot_bring_to_speed_end_the_prediction():
    heavy = dataclasses.replace(MODEL, parameters={**MODEL.parameters, "wheel_inertia": 4000.0})
    with pytest.raises(BenchError, match="rad/s was requested"):
        predict(plan("[{hold_speed: {speed_km_h: 300, duration_s: 0}}]"), _without_speed_limit(), heavy)


def _without_speed_limit():
    limits = SIM.limits.model_copy(update={"vehicle_speed_m_s": 1e3})
    return SIM.model_copy(
        update={"limits": limits, "dyno": SIM.dyno.model_copy(update={"speed_ramp_m_s2": 100.0})}
    )


def test_a_forecast_judges_each_segment_as_a_whole_prediction_does():
    criteria = """
  - {segment: gain, metric: peak_shaft_torque, upper: 100, unit: N m}
  - {segment: phase, metric: peak_shaft_torque, upper: 1000, unit: N m}
  - {segment: phase, metric: band_energy, channel: motor_speed_rad_s, from_hz: 8, to_hz: 20, below: gain}
"""
    checked = plan(f"{STEPS}  - wait: {{duration_s: 130}}\n", criteria)
    whole = predict(checked, SIM, load_model(SIM.simulation.model))
    found = forecast(checked, SIM)
    assert found.criteria == judge(checked, whole.recording, whole.segments, measured=False)
    assert {name: peak for name, (peak, _) in found.peaks.items()} == {
        name: whole.peaks[name] for name in found.peaks
    }


def test_a_forecast_takes_as_long_as_the_run(tmp_path):
    """The estimate from the plan alone does not know how fast a step leaves the wheels."""
    step = "{segment: s, quantity: driving_torque, from_nm: 0, to_nm: 300, before_s: 0.2, after_s: 4}"
    text = f"\n  - set_controller: {{file: phase_stabilization.toml}}\n  - step: {step}\n"
    checked = plan(f"{text}  - hold_speed: {{speed_km_h: 0, duration_s: 0.5}}\n")
    run = run_plan(RunRequest(checked, sim_bench("duration"), tmp_path))
    assert run.error is None
    assert forecast(checked, SIM).duration_s == pytest.approx(run.result.bench_time_s, abs=0.3)


def test_a_forecast_keeps_no_rows_of_what_is_over(monkeypatch):
    kept = []
    forget = PredictedBench.forget

    def watched(self, before):
        kept.append(len(self.loop.closed.rows))
        forget(self, before)

    monkeypatch.setattr(PredictedBench, "forget", watched)
    step = "{segment: s, quantity: motor_torque, from_nm: 0, to_nm: 5, before_s: 0.1, after_s: 1}"
    forecast(
        plan(f"\n  - repeat: {{times: 3, steps: [{{wait: {{duration_s: 900}}}}, {{step: {step}}}]}}"), SIM
    )
    assert len(kept) > 40
    assert max(kept) < 65_000  # of 2.7 million


def test_a_long_plan_that_analyses_itself_is_not_predicted():
    waits = plan("\n  - repeat: {times: 9, steps: [{wait: {duration_s: 1000}}]}\n")
    checked = waits.model_copy(update={"steps": (*waits.steps, Look())})
    with pytest.raises(BadInputError, match=r"takes 2\.5 h and analyses its own recording: at most 2 h"):
        forecast(checked, SIM)
