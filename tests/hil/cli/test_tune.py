"""`hil tune`: what it writes and says, what it refuses, and what Ctrl-C leaves."""

import json
import re
import signal
import subprocess
import time

import pytest

from hil.app.feedback import Feedback
from hil.app.requests import DiagnoseRequest
from hil.cli._app import guarded
from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from tests.docs.documented import ROOT
from tests.hil.analysis.tuning.trials import FREE, LET_GO, PLAN
from tests.hil.cli.test_commands import HIL

MODEL = "benches/three_inertia.toml"


@pytest.fixture
def inputs(tmp_path):
    (tmp_path / "short.yaml").write_text(PLAN)
    (tmp_path / "free.toml").write_text(FREE)
    return [str(tmp_path / "short.yaml"), "--model", MODEL, "--free", str(tmp_path / "free.toml")]


@pytest.mark.slow
def test_a_controller_with_more_margin_is_written_with_its_reasons(tmp_path, inputs, capsys):
    out = tmp_path / "out"
    options = ["--draws", "2", "--starts", "1", "--processes", "1", "--out", str(out)]
    assert guarded(["tune", *inputs, *options]) == 0
    shown = capsys.readouterr().out
    told = json.loads((out / "tune.json").read_text())
    assert {path.name for path in out.iterdir()} == set(told["files"])
    assert told["worst_margin"] > told["start_worst_margin"]
    assert told["binding"]["criterion"] in shown
    assert len(told["cars"]) == 3
    controller = load_controller(out / "controller.toml")
    assert controller.dfc.feedforward_time_constant_s == pytest.approx(
        told["parameters"]["feed_forward_time_s"]["value"]
    )
    assert (out / "report.pdf").read_bytes().startswith(b"%PDF")
    assert not re.search(r"<h[1-6][^>]*></h", (out / "report.html").read_text("utf-8"))
    assert guarded(["tune", *inputs, *options]) == 2  # results are there


@pytest.mark.slow
def test_what_became_worse_stands_first_in_text_summary_and_report(tmp_path, inputs, capsys):
    out = tmp_path / "out"
    quick = ["--starts", "1", "--processes", "1", "--out", str(out), "--overwrite"]
    assert guarded(["tune", *inputs, *quick]) == 0  # everything is let go
    shown = capsys.readouterr().out.splitlines()
    told = json.loads((out / "tune.json").read_text())
    assert shown[0].startswith(
        "worse than at the start (allowed: 5 % of the start's figure; let go: response_time"
    )
    assert [*told][:2] == ["failed_checks", "worse"]
    worst = told["worse"][0]
    assert shown[1].split()[:2] == worst["words"].split()[:2]
    assert not told["better_in_every_criterion"]
    assert "Margin increased for every criterion, and nothing else" not in " ".join(shown)
    html = (out / "report.html").read_text("utf-8")
    assert 0 < html.index("Compared with the start") < html.index("Hard limits")
    assert worst["words"] in html
    (tmp_path / "free.toml").write_text(FREE.replace(LET_GO, ""))
    assert guarded(["tune", *inputs, *quick]) == 0
    kept = json.loads((out / "tune.json").read_text())
    assert max((one["share"] for one in kept["worse"]), default=0.0) <= 0.05 + 1e-9
    assert kept["worst_margin"] > kept["start_worst_margin"]
    late = "response_time.phase"
    assert (
        kept["kept"]["controllers"]["tuned"][late] <= 1.05 * kept["kept"]["controllers"]["start"][late] + 1e-9
    )
    assert kept["front"]["figures"][-1] == "response_time"


@pytest.mark.slow
def test_one_run_confirms_it_and_a_bench_with_more_dead_time_is_diagnosed(tmp_path, inputs, monkeypatch):
    asked: list[DiagnoseRequest] = []

    def refused(request: DiagnoseRequest, feedback: Feedback) -> None:
        del feedback
        asked.append(request)
        raise BadInputError("not now")

    monkeypatch.setattr("hil.app.tuning.refinement.diagnose_recordings", refused)
    options = ["--starts", "1", "--at-most", "0.05", "--processes", "1", "--runs", "1", "--on-bench"]
    assert guarded(["tune", *inputs, *options, "sim", "--out", str(tmp_path / "same")]) == 0
    written = json.loads((tmp_path / "same" / "tune.json").read_text())
    told = written["confirmed"]
    assert told["agrees"]
    assert len(written["refined"]["runs"]) == 1
    assert "One run: worst margin measured" in (tmp_path / "same" / "report.html").read_text()
    assert max(one["apart"] for one in told["criteria"]) < 0.01
    assert not asked
    bench = (
        (ROOT / "benches/sim.toml").read_text().replace("three_inertia.toml", str(tmp_path / "other.toml"))
    )
    for name in ("rmcu.dbc", "rcs_dyno.eds"):
        bench = bench.replace(name, str(ROOT / "benches" / name))
    (tmp_path / "bench.toml").write_text(bench)
    model = (ROOT / MODEL).read_text().replace("torque_delay = 0.008", "torque_delay = 0.014")
    (tmp_path / "other.toml").write_text(model)
    out = tmp_path / "other"
    options += [str(tmp_path / "bench.toml"), "--differ", "0.1", "--out", str(out)]
    assert guarded(["tune", *inputs, *options]) == 1
    assert not json.loads((out / "tune.json").read_text())["confirmed"]["agrees"]
    assert asked[0].recordings == [out / "bench/01/recording.mcap"]
    assert (out / "bench/01/result.json").is_file()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--free", "nowhere.toml"], "nowhere.toml"),
        (["--may-worsen", "speed"], "'speed' is not one of what a tuning keeps"),
        (["--controller", "other"], "no segment is driven by a controller 'other'"),
        (["--differ", "0"], "--differ"),
        (["--draws", "-1"], "--draws"),
        (["--start", "benches/sim.toml"], "sim.toml"),
        (["--model", "benches/paper_functions.toml"], "no shaft to load"),
    ],
)
def test_wrong_input_is_one_message_and_leaves_nothing(tmp_path, inputs, options, said, capsys):
    out = tmp_path / "out"
    assert guarded(["tune", *inputs, *options, "--out", str(out)]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.slow
def test_ctrl_c_keeps_the_best_so_far(tmp_path, inputs):
    out = tmp_path / "out"
    options = ["--starts", "90", "--out", str(out), "--verbose"]
    process = subprocess.Popen([HIL, "tune", *inputs, *options], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    for line in process.stderr:
        if "worst margin" in line:
            break
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=120)
    assert process.returncode == 130
    assert said.count("error: interrupted") == 1
    assert "Traceback" not in said
    told = json.loads((out / "tune.json").read_text())
    assert told["ended"] == "stopped"
    assert load_controller(out / "controller.toml").name == "tuned"


@pytest.mark.slow
def test_a_second_ctrl_c_ends_it_at_once_and_leaves_nothing(tmp_path, inputs):
    out = tmp_path / "out"
    options = ["--starts", "90", "--draws", "200", "--out", str(out), "--verbose"]
    process = subprocess.Popen([HIL, "tune", *inputs, *options], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    for sign in ("worst margin", "comparing"):
        next(line for line in process.stderr if sign in line)
        process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert said.count("error: interrupted") == 1
    assert "Traceback" not in said
    assert not out.exists()
