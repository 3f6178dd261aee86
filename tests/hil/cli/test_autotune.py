"""`hil autotune`: from a model that lacks something to a confirmed controller, every decision kept."""

import json
import os
import signal
import subprocess
import time

import pytest

from hil.cli._app import guarded
from hil.core.controller import load_controller
from hil.core.model import load_model, model_to_toml
from hil.engine.commissioning.sim_bench import with_hidden
from tests.docs.documented import ROOT
from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.cli.test_commands import HIL
from tests.hil.cli.test_tune_on_bench import FREE, HARDWARE, MODEL

CHIRP_STEP = (
    "chirp: {segment: c, quantity: motor_torque, from_hz: 0.5, to_hz: 30, duration_s: 8, amplitude_nm: 20}"
)
CHIRP = f"""
name: chirp
steps:
  - hold_speed: {{speed_km_h: 20, duration_s: 1}}
  - {CHIRP_STEP}
finally: [ramp_down: {{duration_s: 1}}]
"""
SEQUENCE = """
name: short
identify: chirp.yaml
accept: short.yaml
free: free.toml
rounds: 2
runs: 2
starts: 1
"""


@pytest.fixture
def sequence(tmp_path):
    texts = {"chirp.yaml": CHIRP, "short.yaml": PLAN, "free.toml": FREE, "sequence.yaml": SEQUENCE}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    return str(tmp_path / "sequence.yaml")


def bench_that_hides(folder, **hidden):
    """A simulated bench in virtual time whose axle has more than the shipped model."""
    model = with_hidden(load_model(ROOT / MODEL), {name: str(value) for name, value in hidden.items()})
    (folder / "hidden.toml").write_text(model_to_toml(model))
    bench = (ROOT / "benches/sim.toml").read_text()
    for name in ("rmcu.dbc", "rcs_dyno.eds"):
        bench = bench.replace(name, str(ROOT / "benches" / name))
    (folder / "bench.toml").write_text(bench.replace("three_inertia.toml", str(folder / "hidden.toml")))
    return str(folder / "bench.toml")


def dead_time_of(model):
    extra = next((use.values["extra_delay_s"] for use in model.effects if use.id == "dead_time"), 0.0)
    return model.parameters["torque_delay"] + extra


@pytest.mark.slow
def test_what_a_bench_hides_is_named_added_tuned_for_and_confirmed(tmp_path, sequence, capsys):
    out, bench = tmp_path / "out", bench_that_hides(tmp_path, backlash=0.01, dead_time=0.003)
    options = ["--model", MODEL, "--bench", bench, "--processes", "1", "--out", str(out)]
    assert guarded(["autotune", sequence, *options]) == 0
    shown = capsys.readouterr().out
    told = json.loads((out / "autotune.json").read_text())
    effects = {effect["id"]: effect["parameters"] for effect in told["effects"]}
    assert effects["backlash"]["half_gap_rad"] == pytest.approx(0.01, rel=0.03)
    assert dead_time_of(load_model(out / "model.toml")) == pytest.approx(0.011, rel=0.02)
    assert told["agrees"]
    assert told["worst_margin"]["measured"] > told["worst_margin"]["before"] + 0.01
    assert told["worst_margin"]["predicted"] == pytest.approx(told["worst_margin"]["measured"], abs=0.01)
    less = [name for name, of in told["margins"].items() if of["measured"] < of["before"]]
    assert told["traded"] == less
    assert next(iter(told)) == "worse"
    assert all(one["words"] in " ".join(shown.split()) for one in told["worse"])
    assert told["ended"].startswith("prediction and run agree, and the margin no longer grows")
    stages = [decision["stage"] for decision in told["decisions"]]
    assert stages == ["consent", "identify", "before", "diagnose", "diagnose", "tune", "confirm"]
    for decision in told["decisions"]:
        assert decision["decided"]
        assert decision["why"]
        assert not decision["folder"] or (out / decision["folder"] / "report.html").is_file()
    assert {path.name for path in out.iterdir() if path.is_file()} == set(told["files"])
    assert load_controller(out / "controller.toml").meta["as_predicted"] is True
    assert "Worst margin measured" in shown
    html = (out / "report.html").read_text()
    assert all(decision["decided"] in html for decision in told["decisions"])
    assert guarded(["autotune", sequence, *options]) == 2  # results are there


@pytest.mark.slow
def test_what_the_diagnosis_does_not_know_ends_it_with_that_reason(tmp_path, sequence):
    out, bench = tmp_path / "out", bench_that_hides(tmp_path, backlash=0.01)
    text = SEQUENCE.replace("rounds: 2", "rounds: 2\ndiagnose_minutes: 0.001")
    (tmp_path / "sequence.yaml").write_text(text)
    options = ["--model", MODEL, "--bench", bench, "--processes", "1", "--out", str(out)]
    assert guarded(["autotune", sequence, *options]) == 1
    told = json.loads((out / "autotune.json").read_text())
    assert told["ended"].startswith("the diagnosis cannot identify what is missing: ")
    assert told["decisions"][-1]["decided"] == "end"
    assert "processor time" in told["decisions"][-1]["why"]
    assert told["worst_margin"]["measured"] is None
    assert not (out / "controller.toml").exists()
    assert (out / "report.pdf").read_bytes().startswith(b"%PDF")
    runs = [out / name / "recording.mcap" for name in ("identify", "before")]
    made = [run.stat().st_mtime_ns for run in runs]
    assert guarded(["autotune", sequence, *options, "--resume"]) == 1
    assert [run.stat().st_mtime_ns for run in runs] == made
    again = json.loads((out / "autotune.json").read_text())
    assert again["decisions"][:3] == told["decisions"][:3]
    (tmp_path / "chirp.yaml").write_text(CHIRP.replace("amplitude_nm: 20", "amplitude_nm: 18"))
    assert guarded(["autotune", sequence, *options, "--resume"]) == 1  # another plan is run
    assert runs[0].stat().st_mtime_ns != made[0]


@pytest.mark.hunt
def test_a_run_that_is_not_as_predicted_is_explained_in_another_round(tmp_path, sequence):
    out, bench = tmp_path / "out", bench_that_hides(tmp_path, backlash=0.01, dead_time=0.003)
    (tmp_path / "sequence.yaml").write_text(SEQUENCE + "agree_percent: 0.05\n")
    options = ["--model", MODEL, "--bench", bench, "--processes", "1", "--out", str(out)]
    assert guarded(["autotune", sequence, *options]) == 1
    told = json.loads((out / "autotune.json").read_text())
    assert told["ended"] == "all 2 rounds are complete"
    assert not told["agrees"]
    confirmed = [one for one in told["decisions"] if one["stage"] == "confirm"]
    assert [one["decided"] for one in confirmed] == ["diagnose that run, too", "end"]
    assert (out / "round-1/diagnosis-2/diagnosis.json").is_file()
    explained = (out / "round-2/diagnosis/report.html").read_text()
    assert explained.count("recording.mcap") >= 3


@pytest.mark.slow
@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGKILL])
def test_whoever_ends_it_what_is_known_is_kept(tmp_path, sequence, kind):
    out, bench = tmp_path / "out", bench_that_hides(tmp_path, backlash=0.01)
    command = [HIL, "autotune", sequence, "--model", MODEL, "--bench", bench, "--out", str(out)]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("before: "):
            break
    time.sleep(1.5)  # within the diagnosis
    os.kill(process.pid, kind)
    _, said = process.communicate(timeout=120)
    told = json.loads((out / "autotune.json").read_text())
    assert [decision["stage"] for decision in told["decisions"]][:3] == ["consent", "identify", "before"]
    assert json.loads((out / "before/result.json").read_text())["safe_state"] == "confirmed"
    if kind == signal.SIGINT:
        assert process.returncode == 130
        assert said.count("error: interrupted") == 1
        assert "Traceback" not in said
        assert told["ended"] == "interrupted"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nowhere.yaml"], "nowhere.yaml"),
        (["autotun"], "no sequence 'autotun'"),
        (["--bench", HARDWARE], "a person's consent"),
        (["--model", "benches/paper_functions.toml"], "no shaft to load"),
        (["--envelope", "motor_torque_nm=1"], "would leave the envelope"),
        (["--envelope", "bench_time_s=1"], "one run takes"),
        (["--bench", "nowhere"], "nowhere"),
        (["--resume"], "--resume goes with --out"),
    ],
)
def test_wrong_input_is_one_message_and_leaves_nothing(tmp_path, arguments, said, capsys):
    out = tmp_path / "out"
    own = ["--model", MODEL, *arguments] if "--model" not in arguments else arguments
    place = [] if "--resume" in arguments else ["--out", str(out)]
    assert guarded(["autotune", *own, *place]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("short.yaml", "criteria:", "criteria: []\nx:", "unknown key 'x'"),
        (
            "sequence.yaml",
            "accept: short.yaml",
            "accept: chirp.yaml",
            "no criterion depends on a controller",
        ),
        ("sequence.yaml", "identify: chirp.yaml", "identify: none.yaml", "none.yaml"),
        ("sequence.yaml", "free: free.toml", "free: none.toml", "none.toml"),
        ("sequence.yaml", "free: free.toml", "controller: other", "driven by a controller 'other'"),
        ("chirp.yaml", CHIRP_STEP, "wait: {duration_s: 1}", "the plan for identification has no segment"),
    ],
)
def test_a_sequence_that_cannot_be_carried_out_is_refused(tmp_path, sequence, file, old, new, said, capsys):
    path = tmp_path / file
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    out = tmp_path / "out"
    assert guarded(["autotune", sequence, "--model", MODEL, "--out", str(out)]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()
