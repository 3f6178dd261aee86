"""Runs on the simulated bench: what goes well, what fails, and that the bench is safe either way."""

import numpy as np
import pytest

from hil.core.errors import BadInputError, BenchError, InterruptError, OrderlyEndError
from hil.core.recording import read_frames, read_recording
from hil.engine.ipc.ipc import RunRequest
from hil.engine.run.run import run_plan
from sim_backend.bench import Fault, SimulatedBench
from sim_backend.can_interface import attached
from tests.benches_for_tests import SIM, plan, sim_bench

CHIRP = (
    "[{chirp: {segment: c, quantity: motor_torque, from_hz: 1, to_hz: 20, duration_s: 2, amplitude_nm: 10}}]"
)
STEP = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.5}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.5, after_s: 2}
"""
PEAK = "[{segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}]"


def run(tmp_path, steps=CHIRP, criteria="[]", name="run", hook=None, **changes):
    request = RunRequest(plan(steps, criteria), sim_bench(name, **changes), tmp_path)
    if hook:
        request.progress = hook
    return run_plan(request)


def test_a_run_passes_and_its_recording_tells_everything(tmp_path):
    outcome = run(tmp_path, STEP, PEAK)
    assert (outcome.error, outcome.result.verdict, outcome.result.safe_state) == (None, "pass", "confirmed")
    recording = read_recording(outcome.recording)
    segment = outcome.result.segments[0]
    assert (segment.controller, segment.initial_speed_km_h) == ("phase", 10.0)
    inside = recording.between(segment.step_s, segment.end_s)
    assert np.max(inside["shaft_torque_nm"]) == pytest.approx(outcome.result.criteria[0].value)
    np.testing.assert_allclose(np.diff(recording.time_s), 1e-3)
    reference = recording["driving_torque_ref_nm"]
    first = recording.time_s[np.flatnonzero(reference > 0)[0]]
    assert first == pytest.approx(segment.step_s, abs=1.5e-3)
    assert recording.attachments["plan.yaml"].decode() == plan(STEP, PEAK).text
    assert set(recording.attachments) >= {"bench.toml", "model.toml", "run.json",
                                          "controller/phase_stabilization.toml"}  # fmt: skip
    assert recording.metadata["dut"]["serial"] == "SIM-0001"
    assert {event.kind for event in recording.events} >= {"arm", "segment", "safe_state", "controller"}
    frames = read_frames(outcome.recording)
    assert len(frames["rmcu"]) > 3000
    assert len(frames["dyno"]) > 5000


def test_the_same_run_twice_gives_the_same_channels(tmp_path):
    first = read_recording(run(tmp_path / "a").recording)
    second = read_recording(run(tmp_path / "b").recording)
    for name, values in first.channels.items():
        assert values.tobytes() == second[name].tobytes()


def test_a_criterion_that_fails_fails_the_run(tmp_path):
    outcome = run(tmp_path, STEP, "[{segment: s, metric: peak_shaft_torque, upper: 100, unit: N m}]")
    assert (outcome.error, outcome.result.verdict) == (None, "fail")
    assert outcome.result.criteria[0].verdict == "fail"


def test_the_lead_holds_its_torque_limit_without_winding_up(tmp_path):
    steps = STEP.replace("to_nm: 200", "to_nm: 500")
    directory = SIM.source.parent.parent / "test_plans/library/controllers"
    weak = (directory / "phase_stabilization.toml").read_text()
    weak = "\n".join(
        "torque_limit_nm = 30.0" if "torque_limit" in line else line for line in weak.split("\n")
    )
    (tmp_path / "weak.toml").write_text(weak)
    steps = steps.replace("phase_stabilization.toml", str(tmp_path / "weak.toml"))
    recording = read_recording(run(tmp_path, steps).recording)
    assert np.max(np.abs(recording["motor_torque_ref_nm"])) == 30.0


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        (CHIRP.replace("amplitude_nm: 10", "amplitude_nm: 160"), "of motor torque, the bench allows 150"),
        ("[{hold_speed: {speed_km_h: 150, duration_s: 1}}]", "150 km/h, the bench allows 100.8"),
        (STEP.replace("to_nm: 200", "to_nm: 700"), "700 N m of driving torque"),
        (
            STEP.replace("  - set_controller: {file: phase_stabilization.toml}\n", ""),
            "set a controller first",
        ),
    ],
)
def test_a_plan_beyond_the_bench_is_refused_before_anything_moves(steps, said, tmp_path):
    with pytest.raises(BadInputError) as caught:
        run(tmp_path, steps)
    assert said in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_expired_calibration_is_refused(tmp_path):
    import datetime

    dates = {"shaft_torque_left": datetime.date(2020, 1, 1)}
    with pytest.raises(BadInputError, match="shaft_torque_left.*2020-01-01"):
        run(tmp_path, calibration=dates)


@pytest.mark.parametrize(
    ("limit", "channel"),
    [("shaft_torque_nm", "shaft_torque"), ("motor_speed_rad_s", "motor_speed"),
     ("vehicle_speed_m_s", "vehicle_speed")],
)  # fmt: skip
def test_a_measured_limit_trips_and_the_bench_is_safe(limit, channel, tmp_path):
    value = {"shaft_torque_nm": 60.0, "motor_speed_rad_s": 20.0, "vehicle_speed_m_s": 2.9}[limit]
    outcome = run(tmp_path, STEP, PEAK, limits=SIM.limits.model_copy(update={limit: value}))
    assert isinstance(outcome.error, BenchError)
    assert "limit tripped" in str(outcome.error)
    assert channel in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "confirmed")
    assert any(event.kind == "failure" for event in read_recording(outcome.recording).events)


def test_one_noisy_sample_does_not_trip(tmp_path):
    limits = SIM.limits.model_copy(update={"motor_speed_rad_s": 25.0, "persistence_s": 10.0})
    assert run(tmp_path, CHIRP, limits=limits).error is None


def fail_at(name, share, fault):
    def hook(done, text):
        if done > share:
            attached(name).fail(fault)

    return hook


def test_an_rmcu_that_falls_silent_stops_the_run_and_cannot_be_called_safe(tmp_path):
    outcome = run(tmp_path, name="r", hook=fail_at("r", 0.4, Fault.RMCU_SILENT))
    assert isinstance(outcome.error, BenchError)
    assert "stopped coming" in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_confirmed")


def test_a_dyno_that_falls_silent_stops_the_run(tmp_path):
    outcome = run(tmp_path, name="d", hook=fail_at("d", 0.4, Fault.DYNO_SILENT))
    assert isinstance(outcome.error, BenchError)
    assert outcome.result.safe_state == "not_confirmed"


def test_deaf_dynos_go_safe_by_themselves_and_that_is_confirmed(tmp_path):
    outcome = run(tmp_path, name="deaf", hook=fail_at("deaf", 0.4, Fault.DYNO_DEAF))
    assert isinstance(outcome.error, BenchError)
    assert "0x8130" in str(outcome.error)
    assert outcome.result.safe_state == "confirmed"


def test_a_device_that_is_not_safe_does_not_keep_the_other_from_its_safe_state(tmp_path):
    worlds = []

    def hook(done, text):
        if done > 0.4:
            worlds.append(attached("other"))
            worlds[-1].fail(Fault.DYNO_SILENT)

    outcome = run(tmp_path, name="other", hook=hook)
    assert outcome.result.safe_state == "not_confirmed"
    assert "dynos did not confirm" in read_recording(outcome.recording, allow_missing=True).events[-1].text
    assert worlds[-1].rmcu.mode == 0


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.8])
def test_an_interrupt_at_any_moment_ends_safe_with_the_data(share, tmp_path):
    def hook(done, text):
        if done >= share:
            import signal

            signal.raise_signal(signal.SIGINT)

    outcome = run(tmp_path, STEP, PEAK, hook=hook)
    assert isinstance(outcome.error, InterruptError)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "confirmed")
    recording = read_recording(outcome.recording)
    assert abs(recording["motor_torque_ref_nm"][-1]) == 0.0
    assert abs(recording["wheel_speed_rad_s"][-1]) < 1.0


def test_an_internal_error_leaves_a_safe_bench_too(tmp_path):
    def hook(done, text):
        if done > 0.4:
            raise ZeroDivisionError("in a progress display")

    outcome = run(tmp_path, hook=hook)
    assert "ZeroDivisionError" in str(outcome.error)
    assert outcome.result.safe_state == "confirmed"
    (traceback,) = [e.text for e in read_recording(outcome.recording).events if e.kind == "traceback"]
    assert "test_run.py" in traceback
    assert "in a progress display" in traceback


def test_a_fault_while_criteria_are_judged_leaves_a_whole_recording_with_its_traceback(tmp_path, monkeypatch):
    def fails(*arguments):
        raise ZeroDivisionError("in a metric")

    monkeypatch.setattr("hil.engine.run.run.judge", fails)
    outcome = run(tmp_path, STEP, PEAK)
    assert "internal error: ZeroDivisionError: in a metric" in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "confirmed")
    recording = read_recording(outcome.recording)
    assert recording.damage == []
    assert any("in fails" in event.text for event in recording.events if event.kind == "traceback")


def test_a_recording_that_cannot_take_the_result_does_not_keep_it_from_being_told(tmp_path, monkeypatch):
    def fails(recorder, *arguments):
        recorder.writer.close()
        raise BenchError("no space left on device", where="recording")

    monkeypatch.setattr("hil.engine.run.run.store_result", fails)
    outcome = run(tmp_path)
    assert "no space left on device" in str(outcome.error)
    assert outcome.result.safe_state == "confirmed"


@pytest.mark.parametrize(
    ("answers", "refused"),
    [({}, True), ({"terminal": object()}, False), ({"confirmed_by": "A. Prüferin"}, False)],
)
def test_a_prompt_on_hardware_needs_a_terminal_or_a_name(answers, refused, tmp_path):
    hardware = sim_bench("hardware", simulation=None)  # no one gives it its bus
    request = RunRequest(plan("[{operator_prompt: {text: Shut the guard}}]"), hardware, tmp_path, **answers)
    with pytest.raises(BadInputError if refused else BenchError) as caught:
        run_plan(request)
    assert ("there is no terminal to ask on" in str(caught.value)) is refused


class Leaving:
    """Watches a run until it is gone."""

    def __init__(self):
        self.gone, self.told = "", []

    def turned(self):
        return self.gone

    def progress(self, share, text):
        if share > 0.4:
            self.gone = "no one watches this process"

    def concluded(self, *, armed, unsafe):
        self.told.append((armed, unsafe))


def test_a_run_that_nobody_watches_any_more_ends_in_order(tmp_path):
    watched = Leaving()
    request = RunRequest(plan(CHIRP), sim_bench("left"), tmp_path, watched=watched)
    request.progress = watched.progress
    outcome = run_plan(request)
    assert isinstance(outcome.error, OrderlyEndError)
    assert "no one watches this process" in str(outcome.error)
    assert outcome.result.end_steps.startswith("executed: ramp_down")
    assert outcome.result.safe_state == "confirmed"
    assert watched.told == [(True, [])]


def test_idle_nodes_may_be_called_anything(tmp_path):
    outcome = run(tmp_path, dyno=SIM.dyno.model_copy(update={"idle": {"front left": 1, "ghost": 2}}))
    assert outcome.error is None


def test_a_dyno_without_a_heartbeat_keeps_the_bench_from_coming_up(tmp_path, monkeypatch):
    whole = SimulatedBench.take

    def without_two_nodes(world, bus):
        block = whole(world, bus)
        return block[(block["id"] != 0x702) & (block["id"] != 0x704)]

    monkeypatch.setattr(SimulatedBench, "take", without_two_nodes)
    outcome = run(tmp_path, dyno=SIM.dyno.model_copy(update={"idle": {"ghost": 2}}))
    assert isinstance(outcome.error, BenchError)
    assert "no heartbeat from" in str(outcome.error)
    assert "rear right (node 4), ghost (node 2)" in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_needed")


def test_a_bus_that_cannot_be_opened_says_so(tmp_path):
    buses = sim_bench("wrong").buses
    buses["dyno"] = buses["dyno"].model_copy(update={"interface": "no-such-interface"})
    with pytest.raises(BenchError, match="no-such-interface"):
        run(tmp_path, name="wrong", buses=buses)


@pytest.mark.parametrize(
    "named", [{"operator": "x" * 101}, {"confirmed_by": "x" * 101}, {"accept_expired": "x" * 501}]
)
def test_a_name_that_no_report_has_room_for_is_refused_before_anything_moves(tmp_path, named):
    request = RunRequest(plan(CHIRP, "[]"), sim_bench("named"), tmp_path / "out", **named)
    with pytest.raises(BadInputError, match=r"has \d01 characters, at most \d00 are taken"):
        run_plan(request)
    assert not list(tmp_path.glob("out/*"))
