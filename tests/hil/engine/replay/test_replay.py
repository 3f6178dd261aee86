"""What a run's frames give as logs of other tools is what the run recorded, value by value."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drivers import read_rmcu
from hil.core.can.frames import crc8_many
from hil.core.errors import BadInputError
from hil.core.recording import read_as_written, read_recording, run_of, write_frames
from hil.engine import RunRequest, run_plan
from hil.engine.replay._replay import ReplayRequest, replay
from tests.benches_for_tests import SIM, plan, sim_bench

PLAN = plan(
    "[{set_controller: {file: phase_stabilization.toml}},"
    " {step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.3, after_s: 1}}]",
    "[{segment: s, metric: peak_shaft_torque, upper: 500, unit: N m}]",
)
DBC = SIM.rmcu.dbc


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    return run_plan(RunRequest(PLAN, sim_bench("replayed"), tmp_path_factory.mktemp("run"))).recording


@pytest.fixture(scope="module")
def logs(run: Path) -> Path:
    recording = read_recording(run)
    for name in ("a.blf", "a.asc", "a.log", "a.mf4"):
        write_frames(recording, run.parent / name)
    for bus in ("rmcu", "dyno"):  # as two loggers would have it
        lines = (run.parent / "a.log").read_text().splitlines(keepends=True)
        (run.parent / f"{bus}.log").write_text("".join(line for line in lines if f" {bus} " in line))
    return run.parent


def assert_same(out: Path, run: Path) -> None:
    """The run's rows are in the replay, which begins earlier: with the log's first frame."""
    ours, theirs = read_as_written(out), read_as_written(run)
    count = len(theirs.time_s)
    first = next(
        k
        for k in range(len(ours.time_s) - count + 1)
        if np.array_equal(ours["motor_speed_rad_s"][k : k + count], theirs["motor_speed_rad_s"])
    )
    assert ours.channels.keys() == theirs.channels.keys()
    for name, values in theirs.channels.items():
        if name != "time_s":
            np.testing.assert_array_equal(ours[name][first : first + count], values, name)
    np.testing.assert_allclose(np.diff(ours.time_s), 1e-3, rtol=1e-6)


@pytest.mark.parametrize(
    "names", [["a.blf"], ["a.asc"], ["a.log"], ["a.mf4"], ["rmcu.log", "dyno.log"]], ids=str
)
def test_a_log_gives_the_channels_of_the_run(logs: Path, run: Path, tmp_path: Path, names: list[str]) -> None:
    out = tmp_path / "out.mcap"
    replayed = replay(ReplayRequest([logs / name for name in names], bench=SIM), out)
    assert_same(out, run)
    assert replayed.result is None
    assert "no criterion is evaluated" in replayed.remarks[-1]
    recording = read_recording(out, allow_missing=True)
    assert recording.damage == []
    assert recording.attachments["device/rmcu/rmcu.dbc"] == DBC.read_bytes()
    assert any("bus 'dyno' is channel" in event.text for event in recording.events)


def test_a_plan_is_judged_where_the_runs_own_recording_says(logs: Path, run: Path, tmp_path: Path) -> None:
    original = run_of(read_recording(run))
    assert original is not None
    own = replay(ReplayRequest([run], bench=SIM, plan=PLAN), tmp_path / "own.mcap").result
    request = ReplayRequest([logs / "a.blf"], bench=SIM, plan=PLAN, segments=run)
    by_log = replay(request, tmp_path / "log.mcap").result
    for result in (own, by_log):
        assert result is not None
        assert result.verdict == "pass"
        assert result.criteria[0].value == pytest.approx(original.criteria[0].value, rel=1e-12)
        assert result.safe_state == "not_needed"
    assert own is not None
    kept = read_recording(tmp_path / "own.mcap", allow_missing=True)
    assert run_of(kept) == own
    assert kept.attachments["plan.yaml"].decode() == PLAN.text
    rows = read_as_written(tmp_path / "own.mcap").time_s
    assert own.bench_time_s == pytest.approx(rows[-1] - rows[0], abs=1e-3)
    assert own.real_time_factor > 0


def test_segments_as_a_person_says_and_what_the_log_does_not_hold(logs: Path, tmp_path: Path) -> None:
    told = tmp_path / "segments.json"
    told.write_text(json.dumps({"segments": [{"id": "s", "start_s": 0.5, "step_s": 0.8, "end_s": 90}]}))
    request = ReplayRequest([logs / "a.log"], bench=SIM, plan=PLAN, segments=told)
    result = replay(request, tmp_path / "out.mcap").result
    assert result is not None
    assert (result.verdict, result.criteria[0].verdict) == ("error", "not_judged")


def test_a_plan_without_segments_is_not_judged_and_says_why(logs: Path, tmp_path: Path) -> None:
    result = replay(ReplayRequest([logs / "a.log"], bench=SIM, plan=PLAN), tmp_path / "out.mcap").result
    assert result is not None
    assert result.verdict == "error"
    assert "the times of the plan's segments in the log are not known" in result.reason


def test_by_a_dbc_each_signal_is_a_channel(logs: Path, run: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.mcap"
    replayed = replay(ReplayRequest([logs / "a.mf4"], dbcs={"1": DBC}), out)
    recording = read_recording(out, allow_missing=True, any_replay=True)
    speed = read_as_written(run)["motor_speed_rad_s"]
    found = recording["MotorSpeed"]
    assert any(np.array_equal(found[k : k + len(speed)], speed) for k in range(len(found) - len(speed) + 1))
    assert recording.metadata["units"]["MotorSpeed"] == "rad/s"
    assert {"RMCU_Request_Counter", "RMCU_Control_Counter"} <= set(replayed.channels)  # names of several
    with pytest.raises(BadInputError, match="motor_torque_ref_nm"):
        read_recording(out, allow_missing=True)


@pytest.mark.parametrize(
    ("request_", "what"),
    [
        ({"buses": {"rmcu": "9"}, "bench": SIM}, "no log has a channel '9'"),
        ({"buses": {"x": "1"}, "bench": SIM}, "the bench has no bus 'x'"),
        ({"dbcs": {"9": DBC}}, "no log has a channel '9'"),
        ({"bench": SIM, "segments": Path("x")}, "--segments goes with --plan"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_what_does_not_go_together_is_refused_and_leaves_nothing(logs, tmp_path, request_, what) -> None:
    with pytest.raises(BadInputError, match=what):
        replay(ReplayRequest([logs / "a.mf4"], **request_), tmp_path / "out.mcap")
    assert list(tmp_path.iterdir()) == []


def test_a_log_of_something_else_is_refused_with_what_is_in_it(tmp_path: Path) -> None:
    log = tmp_path / "a.log"
    log.write_text("(1.0) can0 7F0#01\n(1.1) can0 7F1#02\n")
    with pytest.raises(BadInputError) as error:
        replay(ReplayRequest([log], bench=SIM), tmp_path / "out.mcap")
    assert "channel 'can0' of a.log: 2 frames" in error.value.fix
    (tmp_path / "b.log").write_text(log.read_text())
    with pytest.raises(BadInputError, match="it cannot be aligned with the other logs"):
        replay(ReplayRequest([log, tmp_path / "b.log"], bench=SIM), tmp_path / "out.mcap")
    with pytest.raises(
        BadInputError, match="no frame in the log is described by|no frame in the log belongs to"
    ):
        replay(ReplayRequest([log], dbcs={"": DBC}), tmp_path / "out.mcap")


def test_two_channels_that_fit_alike_are_for_a_person_to_tell_apart(tmp_path: Path) -> None:
    log = tmp_path / "a.log"
    layouts = read_rmcu(DBC).layouts
    frames = {}
    for name in ("RMCU_Status", "RMCU_Control"):
        payloads = layouts[name].encode(Counter=np.arange(9))
        payloads |= layouts[name].signals["Crc"].encode(crc8_many(layouts[name].id, payloads))
        frames[layouts[name].id] = payloads.tolist()
    lines = []
    for t in range(9):
        for frame in (f"{i:03X}#{several[t].to_bytes(8, 'little').hex()}" for i, several in frames.items()):
            lines += [f"({t / 1e3:.6f}) {bus} {frame}\n" for bus in ("can0", "can1")]
    log.write_text("".join(lines))
    with pytest.raises(BadInputError, match="bus 'rmcu' may be channel can0 or can1"):
        replay(ReplayRequest([log], bench=SIM), tmp_path / "out.mcap")
    told = replay(ReplayRequest([log], bench=SIM, buses={"rmcu": "can1"}), tmp_path / "out.mcap")
    assert told.remarks[0] == "bus 'rmcu' is channel 'can1': 18 frames, 2 of 7 known identifiers"
    assert told.remarks[1] == "no log has frames of bus 'dyno': its channels are missing"
