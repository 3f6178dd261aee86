"""The commands as a user calls them: outputs, exit codes, messages without traceback."""

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
from pypdf import PdfReader

from hil.core.recording import read_recording

HIL = Path(sys.executable).parent / "hil"
CONTROLLERS = Path(__file__).parents[3] / "test_plans/library/controllers"
QUICK = """
name: quick
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.5}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.5, after_s: 2}
finally:
  - ramp_down: {duration_s: 0.2}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: LIMIT, unit: N m}
"""


def hil(*arguments, code=0, cwd=None):
    done = subprocess.run([HIL, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=300)
    assert done.returncode == code, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The directory of a run that passed, and what `--json` printed."""
    directory = tmp_path_factory.mktemp("finished")
    (directory / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    done = hil(
        "run", directory / "quick.yaml", "--out", directory / "out", "--operator", "A. Tester", "--json"
    )
    return directory / "out", json.loads(done.stdout)


def test_a_run_writes_what_the_reference_says(finished):
    out, result = finished
    assert result == json.loads((out / "result.json").read_text())
    assert (result["verdict"], result["plan"], result["bench"]) == ("pass", "quick", "sim")
    assert result["safe_state"] == "confirmed"
    assert result["real_time_factor"] > 1
    started = read_recording(out / "recording.mcap").metadata["run"]["started_at"]
    assert result["started_at"] == started
    suite = ElementTree.parse(out / "junit.xml").getroot()
    assert started in [one.get("timestamp") for one in suite.iter("testsuite")]
    assert result["files"] == {
        "recording": "recording.mcap", "html": "report.html", "pdf": "report.pdf", "junit": "junit.xml"
    }  # fmt: skip
    assert "A. Tester" in (out / "report.html").read_text()
    assert "pdfaid" in str(PdfReader(out / "report.pdf").xmp_metadata.stream.get_data())
    assert ElementTree.parse(out / "junit.xml").getroot().tag in ("testsuites", "testsuite")


@pytest.mark.slow
def test_the_report_can_be_made_again_from_the_recording_alone(finished, tmp_path):
    out, result = finished
    again = json.loads(hil("report", out / "recording.mcap", "--out", tmp_path, "--json").stdout)
    assert again["criteria"] == result["criteria"]
    assert (tmp_path / "report.pdf").read_bytes()[:5] == b"%PDF-"
    hil("report", out)


@pytest.mark.slow
def test_the_inputs_of_a_recording_run_again_with_the_same_figures(finished, tmp_path):
    out, result = finished
    said = json.loads(
        hil("export", out / "recording.mcap", "--inputs", "--out", tmp_path / "in", "--json").stdout
    )
    assert {"plan.yaml", "bench.toml", "rmcu.dbc", "phase_stabilization.toml"} <= set(said["files"])
    _, command, *arguments = said["command"].split()
    again = json.loads(hil(command, *arguments, "--out", tmp_path / "again", "--json").stdout)
    assert again["criteria"] == result["criteria"]


@pytest.mark.parametrize("ending", ["csv", "parquet", "mf4", "mat"])
def test_exports_are_recordings_again(ending, finished, tmp_path):
    out, _ = finished
    path = tmp_path / f"r.{ending}"
    hil("export", out / "recording.mcap", "--out", path)
    assert len(read_recording(path).time_s) == len(read_recording(out / "recording.mcap").time_s)
    if ending == "csv":
        hil("report", path, "--out", tmp_path / "foreign")
        assert (tmp_path / "foreign" / "report.html").is_file()


@pytest.mark.slow
def test_simulate_writes_the_models_channels_at_the_recordings_times(finished, tmp_path):
    out, _ = finished
    model = Path(__file__).parents[3] / "benches" / "three_inertia.toml"
    hil("simulate", "--model", model, "--input", out / "recording.mcap", "--out", tmp_path / "sim.csv")
    simulated = read_recording(tmp_path / "sim.csv")
    measured = read_recording(out / "recording.mcap")
    assert simulated.time_s[-1] == pytest.approx(measured.time_s[-1])
    assert {"motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"} <= set(simulated.channels)


def test_a_failed_criterion_is_exit_code_1(tmp_path):
    (tmp_path / "quick.yaml").write_text(QUICK.replace("LIMIT", "100"))
    done = hil("run", tmp_path / "quick.yaml", "--out", tmp_path / "out", code=1)
    assert "fail" in done.stdout


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (QUICK.replace("LIMIT", "400").replace("to_nm: 200", "to_nm: 2000"), "2000 N m"),
        (QUICK.replace("LIMIT", "400").replace("hold_speed", "hold_sped"), "hold_sped"),
        (QUICK.replace("LIMIT", "nonsense"), "upper"),
        ("name: [", "line"),
    ],
)
def test_bad_plans_are_exit_code_2_and_leave_nothing(text, said, tmp_path):
    (tmp_path / "quick.yaml").write_text(text)
    done = hil("run", tmp_path / "quick.yaml", "--out", tmp_path / "out", code=2)
    assert said in done.stderr
    assert done.stdout == ""
    assert not (tmp_path / "out").exists() or list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "no-such-plan"],
        ["run", "acceptance", "--bench", "no-such-bench"],
        ["run"],
        ["nonsense"],
        ["report", "no-such-recording.mcap"],
        ["simulate", "--model", "none.toml", "--input", "none.csv", "--out", "x.csv"],
        ["export", "none.csv", "--out", "x.csv"],
        ["check", "no-such-plan"],
        ["schema", "cat"],
    ],
)
def test_wrong_usage_is_exit_code_2_with_one_message(arguments, tmp_path):
    done = hil(*arguments, code=2, cwd=tmp_path)
    assert done.stderr.strip()
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_said_before_the_run(tmp_path):
    (tmp_path / "file").write_text("")
    done = hil("run", "acceptance", "--out", tmp_path / "file" / "out", code=2)
    assert "--out" in done.stderr


@pytest.mark.slow
def test_a_bench_that_fails_is_exit_code_3_and_keeps_the_data(tmp_path):
    bench = (Path(__file__).parents[3] / "benches" / "sim.toml").read_text()
    source = Path(__file__).parents[3] / "benches"
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        bench = bench.replace(f'"{name}"', f'"{source / name}"')
    (tmp_path / "b.toml").write_text(bench.replace("shaft_torque_nm = 1200.0", "shaft_torque_nm = 100.0"))
    (tmp_path / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    done = hil(
        "run", tmp_path / "quick.yaml", "--bench", tmp_path / "b.toml", "--out", tmp_path / "out", code=3
    )
    assert "limit tripped" in done.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert (result["verdict"], result["safe_state"]) == ("error", "confirmed")
    assert len(read_recording(tmp_path / "out" / "recording.mcap").time_s) > 100


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_is_exit_code_130_and_keeps_the_data(number, tmp_path):
    process = subprocess.Popen(
        [HIL, "run", "identification", "--out", tmp_path / "out"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    recording = tmp_path / "out" / "recording.mcap"
    for _ in range(3000):
        if recording.exists() and recording.stat().st_size > 500_000:
            break
        time.sleep(0.02)
    os.kill(process.pid, number)
    _, stderr = process.communicate(timeout=120)
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["safe_state"] == "confirmed"
    assert read_recording(recording)["motor_torque_ref_nm"][-1] == 0.0


def test_check_predicts_and_compares(tmp_path):
    (tmp_path / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    checked = json.loads(hil("check", tmp_path / "quick.yaml", "--json").stdout)
    assert checked["fits"] is True
    assert 3.5 < checked["duration_s"] < 10.0
    predicted = checked["predicted"]["shaft_torque_left_nm"]
    assert 95 < predicted["value"] < predicted["limit"]


def test_the_schema_is_json():
    assert json.loads(hil("schema", "plan").stdout)["$schema"].startswith("https")


def test_help_names_every_command_quickly_and_each_has_its_own():
    listed = hil("--help").stdout
    for command in ("run", "check", "report", "simulate", "export", "schema"):
        assert command in listed
        assert "Usage" in hil(command, "--help").stdout


@pytest.mark.slow
def test_a_recording_that_was_cut_off_is_reported_with_its_plan(finished, tmp_path):
    out, _ = finished
    content = (out / "recording.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(content[: len(content) * 8 // 10])
    cut = json.loads(hil("report", tmp_path / "cut.mcap", "--json", code=1).stdout)
    assert (cut["verdict"], cut["plan"], cut["safe_state"]) == ("error", "quick", "not_confirmed")
    assert cut["segments"][0]["id"] == "s"
    assert "cut off" in (tmp_path / "report.html").read_text()


@pytest.mark.slow
def test_the_report_is_opened_and_nothing_said_where_no_browser_is(tmp_path, monkeypatch):
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {tmp_path}/opened\n')
    browser.chmod(0o755)
    (tmp_path / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    monkeypatch.setenv("BROWSER", f"{browser} %s")
    hil("run", tmp_path / "quick.yaml", "--out", tmp_path / "out", "--open")
    for _ in range(100):
        if (tmp_path / "opened").exists() and (tmp_path / "opened").read_text():
            break
        time.sleep(0.1)
    assert (tmp_path / "opened").read_text().strip() == (tmp_path / "out/report.html").as_uri()
    monkeypatch.setenv("BROWSER", "no-such-browser")
    monkeypatch.setenv("PATH", "/nowhere")
    assert not hil("run", tmp_path / "quick.yaml", "--out", tmp_path / "again", "--open").stderr


def test_a_controller_in_place_of_the_plans_is_loaded_recorded_and_reported(tmp_path):
    own = tmp_path / "own.toml"
    text = (CONTROLLERS / "gain_stabilization.toml").read_text().replace('name = "gain"', 'name = "own"')
    own.write_text(text)
    (tmp_path / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    hil("run", tmp_path / "quick.yaml", "--out", tmp_path / "out", "--controller", own)
    recording = read_recording(tmp_path / "out/recording.mcap")
    assert tomllib.loads(recording.attachments["controller/own.toml"].decode())["name"] == "own"
    assert f'file: "{own}"' in recording.attachments["plan.yaml"].decode()
    assert "controller/phase.toml" not in recording.attachments
