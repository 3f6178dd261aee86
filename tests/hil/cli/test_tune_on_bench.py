"""`hil tune --on-bench`: few runs within what somebody consented to, all of them told."""

import json
import subprocess

import pytest

from hil.cli._app import guarded
from hil.core.controller import load_controller
from hil.core.recording import read_recording
from tests.docs.documented import ROOT
from tests.hil.analysis.tuning.trials import LET_GO, PLAN
from tests.hil.cli.test_commands import HIL
from tests.hil.cli.test_sim_bench import serving

MODEL = "benches/three_inertia.toml"
FREE = f"[free]\nlead_deg = [0.0, 75.0]\nfeed_forward_time_s = [0.03, 0.2]\n{LET_GO}"
HARDWARE = "benches/rear_axle_socketcan.toml"


@pytest.fixture
def inputs(tmp_path):
    (tmp_path / "short.yaml").write_text(PLAN)
    (tmp_path / "free.toml").write_text(FREE)
    options = ["--free", str(tmp_path / "free.toml"), "--starts", "1", "--processes", "1"]
    return ["tune", str(tmp_path / "short.yaml"), "--model", MODEL, *options]


def bench_with(folder, **numbers):
    """A simulated bench whose axle has other numbers than the model that is given."""
    model, bench = (ROOT / MODEL).read_text(), (ROOT / "benches/sim.toml").read_text()
    for name, value in numbers.items():
        line = next(line for line in model.splitlines() if line.startswith(f"{name} ="))
        model = model.replace(line, f"{name} = {value}")
    for name in ("rmcu.dbc", "rcs_dyno.eds"):
        bench = bench.replace(name, str(ROOT / "benches" / name))
    (folder / "other.toml").write_text(model)
    (folder / "bench.toml").write_text(bench.replace("three_inertia.toml", str(folder / "other.toml")))
    return str(folder / "bench.toml")


@pytest.mark.slow
def test_every_run_stands_in_the_report_with_its_decision_and_the_best_is_what_is_loaded(
    tmp_path, inputs, capsys
):
    out, bench = tmp_path / "out", bench_with(tmp_path, shaft_stiffness=4500.0)
    (tmp_path / "short.yaml").write_text(PLAN.replace("upper: 1}", "upper: 0.012}"))
    options = ["--on-bench", bench, "--runs", "3", "--out", str(out)]
    assert guarded([*inputs, *options]) == 1  # better than the first run, and still beyond that limit
    shown = capsys.readouterr().out
    told = json.loads((out / "tune.json").read_text())
    refined = told["refined"]
    assert refined["consent"] == ""
    assert refined["envelope"]["runs"] == 3
    assert len(refined["runs"]) == 3
    assert refined["worst_margin"] > min(refined["runs"][0]["measured"].values())
    best = load_controller(out / "controller.toml")
    assert best.meta["measured_in_run"] == refined["best_run"]
    of_run = load_controller(out / f"bench/{refined['best_run']:02d}.toml")
    assert best.dfc == of_run.dfc
    for run in refined["runs"]:
        assert run["decision"] in shown
        recording = read_recording(out / f"bench/{run['number']:02d}/recording.mcap", allow_missing=True)
        assert f"{run['number']:02d}.toml" in recording.attachments["plan.yaml"].decode()
    html = (out / "report.html").read_text()
    assert "On the bench" in html
    assert all(run["reason"] in html for run in refined["runs"])


@pytest.mark.slow
def test_a_bench_of_hardware_wants_a_name_and_then_goes_on_unasked(tmp_path, inputs):
    out = tmp_path / "out"
    for attempt, time_scale in enumerate(("0.5", "0.2", "0.2")):  # a machine that stood still trips it
        out = tmp_path / str(attempt)
        options = ["--at-most", "0.02", "--runs", "2", "--confirm", "A. Tester", "--out", str(out)]
        with serving(tmp_path, "--hide", "dead_time=0.003", "--time-scale", time_scale) as (_, file):
            command = [HIL, *inputs, *options, "--on-bench", str(file)]
            done = subprocess.run(
                command, cwd=ROOT, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=300
            )
        if done.returncode != 3:
            break
    assert done.returncode == 0, done.stderr
    assert "at most 2 runs" in done.stderr
    refined = json.loads((out / "tune.json").read_text())["refined"]
    assert refined["consent"] == "A. Tester"
    assert refined["runs"][0]["decision"] == "first"
    result = json.loads((out / "bench/01/result.json").read_text())
    assert result["safe_state"] == "confirmed"
    assert any(limit["name"] == "envelope_motor_torque_nm" for limit in result["limits"])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--runs", "3"], "--runs goes with --on-bench"),
        (["--confirm", "me"], "--confirm goes with --on-bench"),
        (["--then-run"], "use --on-bench BENCH --runs 1"),
        (["--on-bench", "sim", "--bench", "sim"], "--bench does not go with --on-bench"),
        (["--on-bench", "nowhere"], "nowhere"),
        (["--on-bench", HARDWARE], "a person's consent"),
        (["--on-bench", "sim", "--envelope", "motor_torque_nm"], "has no '='"),
        (["--on-bench", "sim", "--envelope", "motor_torque_nm=1"], "would leave the envelope"),
        (["--on-bench", "sim", "--envelope", "motor_torque_nm=1000"], "up to the bench's 150"),
        (["--on-bench", "sim", "--envelope", "bench_time_s=1"], "one run takes"),
    ],
)
def test_wrong_input_is_one_message_and_leaves_nothing(tmp_path, inputs, options, said, capsys):
    out = tmp_path / "out"
    assert guarded([*inputs, *options, "--out", str(out)]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()
