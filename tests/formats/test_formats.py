"""Files of earlier versions are still read: a folder for each version, which no one changes any more.

They are a run's own: `hil run plan.yaml --bench bench.toml`, and its export. A format that changes gets a
folder beside these.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from hil.core.controller import load_controller
from hil.core.model import load_model
from hil.core.recording import read_recording, run_of
from hil.core.result import RunResult
from hil.engine import load_bench
from test_plans import judge, load_plan, plan_from_text
from tests.hil.cli.test_commands import hil

HERE = Path(__file__).parent
VERSIONS = sorted(path for path in HERE.iterdir() if path.name[0].isdigit())


@pytest.fixture(params=VERSIONS, ids=lambda path: path.name)
def folder(request: pytest.FixtureRequest) -> Path:
    return Path(request.param)


def test_plan_bench_model_and_controller_are_read(folder):
    plan = load_plan(folder / "plan.yaml")
    assert [segment.id for segment in plan.segments] == ["s"]
    assert [str(value) for value in plan.values] == ["torque_nm = 40 N m"]
    assert load_bench(folder / "bench.toml").limits.shaft_torque_nm == 1200.0
    assert load_model(folder / "three_inertia.toml").parameters["gear_ratio"] == 8.148
    assert load_controller(folder / "controller.toml").stabilization == "phase"


@pytest.mark.parametrize("name", ["recording.mcap", "recording.csv"])
def test_a_recording_gives_the_values_that_were_judged(folder, name):
    recording = read_recording(folder / name)
    assert recording.damage == []
    run = run_of(recording)
    assert run is not None
    assert (run.verdict, run.plan, run.bench) == ("pass", "small", "sim")
    text = recording.attachments["plan.yaml"].decode()
    plan = plan_from_text(text, name, folder, files_required=False)
    (again,) = judge(plan, recording, run.segments)
    assert again.value == pytest.approx(run.criteria[0].value, rel=1e-6)
    assert recording.metadata["run"]["started_at"].startswith("2026-")


def test_an_export_has_the_samples_of_its_recording(folder):
    table, original = (read_recording(folder / name) for name in ("recording.csv", "recording.mcap"))
    for name in original.channels:
        np.testing.assert_allclose(table[name], original[name], rtol=1e-8, atol=1e-9)


def test_a_result_is_read(folder):
    result = RunResult.model_validate_json((folder / "result.json").read_text("utf-8"))
    assert result.verdict == "pass"
    assert result.criteria[0].id == "s.peak_shaft_torque"


@pytest.mark.slow
def test_its_report_is_made_again(folder, tmp_path):
    shutil.copy(folder / "recording.mcap", tmp_path / "recording.mcap")
    hil("report", tmp_path / "recording.mcap", "--out", tmp_path / "out")
    assert (tmp_path / "out/report.pdf").is_file()
