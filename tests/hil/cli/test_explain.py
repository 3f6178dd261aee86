"""`hil explain`: what it writes and says, what it refuses, and what Ctrl-C leaves."""

import json
import signal
import subprocess

import pytest

from hil.cli._app import guarded
from tests.hil.cli.test_commands import HIL

PLAN = """
name: quick
steps:
  - set_controller: {file: gain_stabilization.toml}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.1, after_s: 0.6}
criteria:
  - {segment: s, metric: peak_shaft_torque}
"""
TARGET = "s.peak_shaft_torque=430"


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "quick.yaml"
    path.write_text(PLAN)
    return str(path)


@pytest.mark.slow
def test_rivals_are_ranked_and_their_models_written(tmp_path, plan, capsys):
    out = tmp_path / "out"
    options = ["--plan", plan, "--target", TARGET, "--evaluations", "40", "--out", str(out)]
    code = guarded(["explain", *options])
    shown = capsys.readouterr().out
    told = json.loads((out / "targets.json").read_text())
    assert code == (0 if told["reached"] else 1)
    assert told["verdict"][:40] in shown
    assert "not single out a cause" in told["caution"]
    assert {path.name for path in out.iterdir()} == set(told["files"])
    ranks = [(len(rival["missed"]), rival["cost"]) for rival in told["rivals"]]
    assert ranks == sorted(ranks)
    assert guarded(["check", plan]) == 0
    assert guarded(["run", plan, "--model", str(out / "rival_1.toml"), "--out", str(tmp_path / "run")]) == 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "no target is given"),
        (["--target", "s.peak_shaft_torqe=1"], "did you mean 's.peak_shaft_torque'?"),
        (["--target", TARGET, "--bench", "rear_axle_socketcan"], "is not a simulated bench"),
        (["--target", TARGET, "--evaluations", "1"], "--evaluations"),
        (["nowhere.toml"], "nowhere.toml"),
        (["--target", TARGET, "--among", "backlach"], "did you mean 'backlash'?"),
    ],
)
def test_wrong_input_is_one_message_and_leaves_nothing(tmp_path, plan, options, said, capsys):
    out = tmp_path / "out"
    assert guarded(["explain", *options, "--plan", plan, "--out", str(out)]) == 2
    shown = capsys.readouterr()
    assert said in shown.err
    assert shown.out == ""
    assert not out.exists()


@pytest.mark.slow
def test_an_interrupted_search_keeps_what_it_knows(tmp_path, plan):
    out = tmp_path / "out"
    options = ["--plan", plan, "--target", TARGET, "--evaluations", "90000", "--out", out, "--verbose"]
    with subprocess.Popen(
        [HIL, "explain", *options], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    ) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if "best so far" in line:
                process.send_signal(signal.SIGINT)
                break
        errors = process.stderr.read()
    assert process.returncode == 130, errors
    assert "interrupted" in errors
    assert "Traceback" not in errors
    told = json.loads((out / "targets.json").read_text())
    assert told["interrupted"]
    assert told["evaluations"] >= 1
    assert told["rivals"]
