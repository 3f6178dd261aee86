"""`hil compare`: what it prints and writes, and what it refuses."""

import json

import pytest

from hil.cli._app import guarded
from test_plans.loading import LIBRARY
from tests.hil.cli.test_check import PLAN

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Directories of two runs of one plan, and of a run with another limit."""
    folder = tmp_path_factory.mktemp("runs")
    for name, limit in (("one", 400), ("two", 400), ("other", 300)):
        (folder / f"{name}.yaml").write_text(PLAN.replace("LIMIT", str(limit)))
        assert guarded(["run", str(folder / f"{name}.yaml"), "--out", str(folder / name)]) == 0
    return folder


def test_criteria_side_by_side(runs, capsys):
    out = runs / "compared"
    assert guarded(["compare", str(runs / "one"), str(runs / "two"), "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    (peak,) = (line.split() for line in shown.splitlines() if line.startswith("s.peak_shaft_torque"))
    assert peak[1] == peak[2]
    assert peak[3] == "(0.0"
    assert {path.name for path in out.iterdir()} == {"comparison.json", "report.html", "report.pdf"}
    told = json.loads((out / "comparison.json").read_text())
    assert [run["name"] for run in told["runs"]] == ["one", "two"]
    assert guarded(["compare", str(runs / "one"), str(runs / "two"), "--out", str(out), "--json"]) == 2
    assert "holds results already" in capsys.readouterr().err
    options = ["--out", str(out), "--overwrite", "--json"]
    assert guarded(["compare", str(runs / "one"), str(runs / "two"), *options]) == 0
    assert json.loads(capsys.readouterr().out) == told


def test_a_changed_copy_is_compared_and_what_differs_is_said(runs, capsys):
    out = runs / "to_other"
    assert guarded(["compare", str(runs / "one"), str(runs / "other"), "--out", str(out)]) == 0
    line = "The plan of other differs: criterion s.peak_shaft_torque: upper 300 N m instead of 400 N m."
    assert line in capsys.readouterr().out
    assert line in (out / "report.html").read_text("utf-8")
    (told,) = json.loads((out / "comparison.json").read_text())["differences"]
    assert (told["run"], told["kind"], told["first"], told["other"]) == ("other", "plan", "400", "300")


def test_runs_with_other_controllers_share_a_heading_that_names_neither(runs):
    other = str(LIBRARY / "controllers/gain_stabilization.toml")
    assert guarded(["run", str(runs / "one.yaml"), "--controller", other, "--out", str(runs / "gain")]) == 0
    for name, heading in (("two", "Phase stabilization, "), ("gain", "Step, ")):
        assert (
            guarded(["compare", str(runs / "one"), str(runs / name), "--out", str(runs / f"to_{name}")]) == 0
        )
        assert f"<h2>{heading}" in (runs / f"to_{name}/report.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (("one",), "one run cannot be compared"),
        (("one", "one"), "is given twice"),
        (("one", "nowhere"), "there is no such file"),
    ],
)
def test_what_cannot_be_compared_is_one_message(runs, names, message, capsys):
    out = runs / "refused"
    assert guarded(["compare", *(str(runs / name) for name in names), "--out", str(out)]) == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert shown.out == ""
    assert not out.exists()


def test_variables_and_start_of_each_run_are_shown(runs, capsys):
    text = PLAN.replace("LIMIT", "400").replace("to_nm: 200", "to_nm: $torque_nm")
    assert "$torque_nm" in text
    varied = runs / "varied.yaml"
    varied.write_text(f"{text}\nvariables: {{torque_nm: {{default: 150, unit: N m, upper: 300}}}}\n")
    for name in ("low", "low_again"):
        assert guarded(["run", str(varied), "--set", "torque_nm=120", "--out", str(runs / name)]) == 0
    out = runs / "compared_varied"
    capsys.readouterr()
    assert guarded(["compare", str(runs / "low"), str(runs / "low_again"), "--out", str(out)]) == 0
    assert "low_again: torque_nm = 120 N m" in capsys.readouterr().out
    told = json.loads((out / "comparison.json").read_text())
    assert [run["variables"] for run in told["runs"]] == [{"torque_nm": 120.0}] * 2
    assert all(run["started_at"] for run in told["runs"])
    assert "torque_nm = 120 N m" in (out / "report.html").read_text("utf-8")
