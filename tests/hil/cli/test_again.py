"""`hil run --again`: an earlier run once more, out of its recording alone."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from hil.app.again import compared_in_words
from hil.cli._app import guarded
from hil.core.result import CriterionResult, RunResult
from tests.docs.documented import ROOT
from tests.hil.cli.test_commands import hil
from tests.hil.cli.test_series import PLAN


@pytest.mark.slow
def test_it_is_the_same_run_without_its_files_and_says_what_has_changed(tmp_path: Path) -> None:
    (tmp_path / "tip.yaml").write_text(PLAN)
    controller = (ROOT / "test_plans/library/controllers/phase_stabilization.toml").read_text()
    (tmp_path / "soft.toml").write_text(controller)
    first = tmp_path / "first"
    loaded = f"phase_stabilization.toml={tmp_path / 'soft.toml'}"
    hil("run", tmp_path / "tip.yaml", "--set", "torque_nm=100", "--controller", loaded, "--out", first)
    (tmp_path / "tip.yaml").unlink()
    (tmp_path / "soft.toml").write_text(controller.replace("name =", "# changed\nname ="))
    done = hil("run", "--again", first, "--out", tmp_path / "second", "--json")
    assert "soft.toml has changed since; the recorded one is used" in done.stderr
    assert "tip.yaml is not there any more; the recorded one is used" in done.stderr
    assert "values are equal to those of the earlier run" in done.stderr
    before = json.loads((first / "result.json").read_text())
    assert json.loads(done.stdout)["criteria"] == before["criteria"]
    assert json.loads(done.stdout)["variables"][0]["value"] == 100
    other = hil(
        "run", "--again", first / "recording.mcap", "--set", "torque_nm=120", "--out", tmp_path / "third"
    )
    assert "values differ from the earlier run's" in other.stderr
    again = hil("run", "--again", tmp_path / "third", "--out", tmp_path / "fourth")
    assert "was one of --again itself" in again.stderr
    misspelt = hil("run", "--again", first, "--set", "torque=200", code=2)
    assert "hil-again" not in misspelt.stderr


@pytest.mark.slow
def test_whatever_lies_beside_the_plan_is_compared_and_the_run_itself_is_never_replaced(
    tmp_path: Path,
) -> None:
    """Files named without a folder, the plan and bench themselves, the model, descriptions of devices."""
    for name, source in (
        ("c.toml", "test_plans/library/controllers/phase_stabilization.toml"),
        ("bench.toml", "benches/sim.toml"),
        ("rmcu.dbc", "benches/rmcu.dbc"),
        ("rcs_dyno.eds", "benches/rcs_dyno.eds"),
        ("m.toml", "benches/three_inertia.toml"),
    ):
        (tmp_path / name).write_text((ROOT / source).read_text())
    bench = (tmp_path / "bench.toml").read_text()
    (tmp_path / "bench.toml").write_text(re.sub(r'model = "[^"]*"', 'model = "m.toml"', bench))
    (tmp_path / "tip.yaml").write_text(PLAN.replace("phase_stabilization.toml", "c.toml"))
    first = tmp_path / "first"
    command = ("run", tmp_path / "tip.yaml", "--set", "torque_nm=100", "--bench", tmp_path / "bench.toml")
    hil(*command, "--out", first)
    same = hil("run", "--again", first, "--out", tmp_path / "same")
    assert "software and files are those of the earlier run" in same.stderr
    changes = {"tip.yaml": "# x\n", "c.toml": "# x\n", "bench.toml": "# x\n", "m.toml": "", "rmcu.dbc": "\n"}
    for name, more in changes.items():
        text = (tmp_path / name).read_text()
        changed = text.replace("6089", "5000") if name == "m.toml" else text + more
        assert changed != text, name
        (tmp_path / name).write_text(changed)
    (tmp_path / "rcs_dyno.eds").unlink()
    done = hil("run", "--again", first, "--out", tmp_path / "second")
    assert "rcs_dyno.eds is not there any more" in done.stderr
    for name in changes:
        assert f"{name} has changed since" in done.stderr
    assert "values are equal to those of the earlier run" in done.stderr
    refused = hil("run", "--again", first, "--out", first, "--overwrite", code=2)
    assert "recording.mcap" in refused.stderr


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["run"], "nothing to run is named"),
        (["run", "acceptance", "--again", "out"], "a plan does not go with --again"),
        (["run", "--again", "nowhere"], "there is no such run"),
        (["run", "--again", str(ROOT / "README.md")], "recordings end in"),
        (["run", "--again", "out", "--server", "http://127.0.0.1:1"], "--server does not go with --again"),
        (["list", "plans", "--sort", "plan"], "--sort goes with `hil list runs`"),
        (["list", "plans", "out"], "DIR goes with `hil list runs`"),
        (["list", "runs", str(ROOT / "benches"), "--since", "yesterday"], "'yesterday' is no date"),
        (["list", "runs", "out", "--criterion", "s.jerk", "--above", "nan"], "a bound of nan bounds nothing"),
        (
            ["list", "runs", "out", "--criterion", "s.jerk", "--above", "5", "--below", "3"],
            "no value is above 5 and below 3",
        ),
    ],
)
def test_wrong_input_is_one_message(
    options: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert guarded(options) == 2
    assert said in capsys.readouterr().err


def test_runs_of_a_folder_are_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = _result(peak=240.0)
    (tmp_path / "a").mkdir()
    (tmp_path / "a/result.json").write_text(result.model_dump_json())
    (tmp_path / "b").mkdir()
    (tmp_path / "b/result.json").write_text("{")
    assert guarded(["list", "runs", str(tmp_path), "--criterion", "s.peak"]) == 0
    out, err = capsys.readouterr()
    assert "4.0 %" in out
    assert "240 N m" in out
    assert f"{tmp_path / 'b/result.json'}: is no result of a run" in err
    assert guarded(["list", "runs", str(tmp_path), "--json", "--since", "2030-01-01"]) == 0
    assert json.loads(capsys.readouterr().out) == {"runs": [], "total": 0}
    assert guarded(["list", "runs", str(tmp_path), "--since", "2030-01-01"]) == 0
    assert "none of the 1 runs" in capsys.readouterr().out


def test_the_largest_difference_is_named() -> None:
    before = _result(peak=240.0, energy=2.0)
    assert "all 2 values are equal" in compared_in_words(before, before)
    text = compared_in_words(before, _result(peak=246.0, energy=2.5))
    assert text == "2 of 2 values differ from the earlier run's, s.energy most: 2 then, 2.5 now (25 %)"
    from_zero = compared_in_words(_result(peak=0.0), _result(peak=0.7))
    assert from_zero == "1 of 1 values differ from the earlier run's, s.peak most: 0 then, 0.7 now"
    assert "no criterion" in compared_in_words(before, _result())


def _result(**values: float) -> RunResult:
    criteria = tuple(
        CriterionResult(id=f"s.{name}", value=value, unit="N m", upper=250.0, verdict="pass")
        for name, value in values.items()
    )
    return RunResult(
        verdict="pass",
        plan="p",
        bench="b",
        started_at="2026-11-28T00:00:00+00:00",
        real_time_factor=1.0,
        bench_time_s=1.0,
        safe_state="confirmed",
        criteria=criteria,
    )
