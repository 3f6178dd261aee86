"""The how-to's package, installed as its reader would, does what the how-to says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from test_plans import plan_from_text, plan_schema
from tests.benches_for_tests import sim_bench

PAGE = Path(__file__).parents[2] / "docs/how-to/own-steps-and-metrics.md"


def block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found
    return found[1]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "axle_lab.py").write_text(block("python"))
    installed = tmp_path / "axle_lab-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: axle_lab\nVersion: 1.0\n")
    points = re.sub(r'project\.entry-points\."(.*?)"', r"\1", block("toml")).replace('"', "")
    (installed / "entry_points.txt").write_text(points)
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.usefixtures("package")
def test_the_plan_runs_and_its_metric_is_judged(tmp_path: Path) -> None:
    plan = plan_from_text(block("yaml"), "tip-in.yaml", tmp_path)
    outcome = run_plan(RunRequest(plan, sim_bench("own-steps"), tmp_path / "out"))
    (criterion,) = outcome.result.criteria
    assert (outcome.error, criterion.verdict, criterion.unit) == (None, "pass", "rad/s")
    assert criterion.definition.startswith("Root mean square of motor_speed_rad_s (ω_m) from the step until")
    segment = outcome.result.segments[0]
    inside = read_recording(outcome.recording).between(segment.start_s, segment.end_s)
    assert max(inside["motor_torque_ref_nm"]) == pytest.approx(20.0, abs=0.05)
    assert "half_sine" in str(plan_schema())
