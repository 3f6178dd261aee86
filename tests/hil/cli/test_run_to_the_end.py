"""What is left of a run, however it ends: the result first, no old report beside a new one, right codes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from hil.core.recording import read_recording
from tests.hil.cli.test_commands import HIL, QUICK, hil

BENCHES = Path(__file__).parents[3] / "benches"


def plan_in(directory: Path, text: str = QUICK, limit: str = "400") -> Path:
    path = directory / "quick.yaml"
    path.write_text(text.replace("LIMIT", limit))
    return path


def bench_in(directory: Path, *changes: tuple[str, str]) -> Path:
    text = (BENCHES / "sim.toml").read_text()
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{BENCHES / name}"')
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = directory / "bench.toml"
    path.write_text(text)
    return path


@pytest.mark.slow
def test_the_same_out_twice_needs_overwrite_and_leaves_nothing_of_the_first(tmp_path: Path) -> None:
    plan, out = plan_in(tmp_path), tmp_path / "out"
    hil("run", plan, "--out", out)
    first = (out / "recording.mcap").read_bytes()
    done = hil("run", plan, "--out", out, code=2)
    assert "holds results already" in done.stderr
    assert (out / "recording.mcap").read_bytes() == first
    hil("run", plan_in(tmp_path, limit="4000000"), "--bench", "nowhere", "--out", out, "--overwrite", code=2)
    assert (out / "report.pdf").exists()  # a mistake costs nothing
    tripping = bench_in(tmp_path, ("shaft_torque_nm = 1200.0", "shaft_torque_nm = 100.0"))
    hil("run", plan, "--bench", tripping, "--out", out, "--overwrite", code=3)
    result = json.loads((out / "result.json").read_text())
    assert result["verdict"] == "error"
    assert {c["verdict"] for c in result["criteria"]} == {"not_judged"}
    assert ">Error</h2>" in (out / "report.html").read_text()
    assert 'skipped="6"' in (out / "junit.xml").read_text()


@pytest.mark.slow
def test_without_out_runs_are_numbered(tmp_path: Path) -> None:
    plan = plan_in(tmp_path)
    for _ in range(2):
        hil("run", plan, cwd=tmp_path)
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["quick-001", "quick-002"]


@pytest.mark.slow
def test_a_bench_without_devices_is_exit_code_3_and_points_to_what_exists(tmp_path: Path) -> None:
    dead = bench_in(tmp_path, ('interface = "hil-sim"', 'interface = "virtual"'))
    text = dead.read_text()
    dead.write_text(text[: text.index("[simulation]")])
    done = hil("run", plan_in(tmp_path), "--bench", dead, "--out", tmp_path / "out", code=3)
    assert "the RMCU sends no status" in done.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert (result["verdict"], result["safe_state"]) == ("error", "not_needed")
    for name in result["files"].values():
        assert (tmp_path / "out" / name).is_file()


@pytest.mark.slow
def test_a_plan_without_criteria_is_not_green(tmp_path: Path) -> None:
    text = QUICK[: QUICK.index("criteria:")]
    done = hil("run", plan_in(tmp_path, text), "--out", tmp_path / "out")
    assert "DONE, 1 segment recorded, 5 of 5 device checks passed" in done.stdout
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Executed, nothing judged" in page
    assert 'class="banner pass"' not in page


@pytest.mark.slow
def test_reports_are_renewed_in_place_but_not_those_of_another_recording(tmp_path: Path) -> None:
    out = tmp_path / "out"
    hil("run", plan_in(tmp_path), "--out", out)
    hil("report", out)
    hil("report", out / "recording.mcap")
    hil("export", out / "recording.mcap", "--out", out / "other.csv")
    assert "holds results already" in hil("report", out / "other.csv", code=2).stderr
    hil("report", out / "other.csv", "--out", tmp_path / "foreign")
    assert "holds results already" in hil("report", out, "--out", tmp_path / "foreign", code=2).stderr
    hil("report", out, "--out", tmp_path / "foreign", "--overwrite")
    assert "exists already" in hil("export", out, "--out", out / "other.csv", code=2).stderr


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
@pytest.mark.parametrize("sign", ["recording.mcap", "junit.xml"])
def test_a_signal_at_any_time_leaves_a_result(number: int, sign: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [str(HIL), "run", str(plan_in(tmp_path)), "--out", str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        until = time.monotonic() + 60
        while not (out / sign).exists() and time.monotonic() < until:
            time.sleep(0.005)
        os.kill(process.pid, number)
        time.sleep(0.05)
        os.kill(process.pid, number)  # an impatient second one
        _, stderr = process.communicate(timeout=120)
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr
    result = json.loads((out / "result.json").read_text())
    assert result["safe_state"] == ("confirmed" if sign == "junit.xml" else result["safe_state"])
    assert result["verdict"] == ("pass" if sign == "junit.xml" else "error")
    assert {p.name for p in out.iterdir()} == {"result.json", *result["files"].values()}
    assert read_recording(out / "recording.mcap", least_samples=0).damage == []


@pytest.mark.slow
def test_a_disk_that_fills_up_while_reports_are_written_is_exit_code_3(tmp_path: Path) -> None:
    """The limit on a file's size stands in for a full disk: the recording fits, the report does not."""
    out = tmp_path / "out"
    command = f"ulimit -f 2000; trap '' XFSZ; exec {HIL} run {plan_in(tmp_path)} --out {out}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 3, done.stderr
    assert "File too large" in done.stderr
    result = json.loads((out / "result.json").read_text())
    assert result["verdict"] == "pass"
    assert {p.name for p in out.iterdir()} == {"result.json", *result["files"].values()}


@pytest.mark.slow
def test_a_recording_with_a_broken_bit_proves_nothing_and_every_command_says_so(tmp_path: Path) -> None:
    out = tmp_path / "out"
    hil("run", plan_in(tmp_path), "--out", out)
    content = bytearray((out / "recording.mcap").read_bytes())
    content[len(content) // 2] ^= 4
    (out / "recording.mcap").write_bytes(content)
    done = hil("report", out, "--json", code=1)
    assert "warning:" in done.stderr
    result = json.loads(done.stdout)
    assert result["verdict"] == "error"
    assert "damaged" in result["reason"]
    assert "Damaged recording:" in (out / "report.html").read_text()
    done = hil("export", out / "recording.mcap", "--out", tmp_path / "x.csv", "--json")
    assert "lost" in done.stderr
    assert json.loads(done.stdout)["damage"]
