"""`hil evidence recover` on what a kill leaves of a run, and the report of what it recovered."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.hil.cli.test_commands import QUICK, hil

SECOND = "step: {segment: t, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.5, after_s: 2}"
TWO = (
    QUICK.replace("LIMIT", "400").replace("finally:", f"  - {SECOND}\nfinally:")
    + "  - {segment: t, metric: peak_shaft_torque, upper: 400, unit: N m}\n"
)


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    (folder / "two.yaml").write_text(TWO)
    hil("run", folder / "two.yaml", "--out", folder / "out", "--json")
    return folder / "out"


@pytest.mark.slow
def test_a_run_that_was_killed_is_recovered_and_reported(run: Path, tmp_path: Path) -> None:
    content = (run / "recording.mcap").read_bytes()
    left = content[: int(0.75 * len(content))]
    (tmp_path / "recording.mcap").write_bytes(left)
    told = json.loads(hil("evidence", "recover", tmp_path, "--json").stdout)
    assert told["recovered"] == str(tmp_path / "recording.recovered.mcap")
    assert told["missing"]["files_inside"] == ["run.json"]
    assert told["missing"]["files_beside"] == ["result.json", "junit.xml", "report.html", "report.pdf"]
    assert told["missing"]["segments"] == ["t"]
    assert (tmp_path / "recording.mcap").read_bytes() == left
    again = hil("evidence", "recover", tmp_path, code=2)
    assert "exists already" in again.stderr
    done = hil("report", told["recovered"], "--json", code=1)
    result = json.loads(done.stdout)
    assert result["verdict"] == "error"
    asked = [c["verdict"] for c in result["criteria"] if c["source"] == "plan"]
    assert asked == ["pass", "not_judged"]
    assert "cut off" in result["reason"]
    assert "cut off" in (tmp_path / "report.html").read_text()


@pytest.mark.slow
def test_a_whole_recording_is_left_alone(run: Path) -> None:
    before = sorted(run.iterdir())
    assert "is complete" in hil("evidence", "recover", run).stdout
    assert (
        json.loads(hil("evidence", "recover", run / "recording.mcap", "--json").stdout)["recovered"] is None
    )
    assert sorted(run.iterdir()) == before


@pytest.mark.slow
def test_bad_input_is_one_message(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("time_s\n1.0\n")
    assert "only recordings in MCAP" in hil("evidence", "recover", tmp_path / "r.csv", code=2).stderr
    assert "no such file" in hil("evidence", "recover", tmp_path / "r.mcap", code=2).stderr
    (tmp_path / "r.mcap").write_bytes(b"rubbish")
    assert "not an MCAP file" in hil("evidence", "recover", tmp_path / "r.mcap", code=2).stderr
