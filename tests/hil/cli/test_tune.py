"""`hil tune`: what it writes and says, what it refuses, and what Ctrl-C leaves."""

import json
import signal
import subprocess
import time

import pytest

from hil.cli._app import guarded
from hil.core.controller import load_controller
from tests.hil.analysis.tuning.trials import FREE, PLAN
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
    options = ["--draws", "2", "--generations", "2", "--processes", "1", "--out", str(out)]
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
    run = ["run", inputs[0], "--controller", f"phase_stabilization.toml={out / 'controller.toml'}"]
    assert guarded([*run, "--out", str(tmp_path / "run")]) == 0
    assert guarded(["tune", *inputs, *options]) == 2  # results are there


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--free", "nowhere.toml"], "nowhere.toml"),
        (["--controller", "other"], "no segment is driven by a controller 'other'"),
        (["--bench", "rear_axle_socketcan"], "is no simulated bench"),
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
    options = ["--generations", "900", "--out", str(out), "--verbose"]
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
