"""One map of columns for every command that reads a recording: what was understood is in `--json` too."""

from __future__ import annotations

import html
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil.cli._app import guarded
from hil.core.model import load_model
from hil.core.recording import Recording, read_recording
from hil.plant import replay
from tests.benches_for_tests import SIM

COLUMNS = """
motor_torque_ref_nm = "M_soll"
shaft_torque_nm = "M_welle"
[time_s]
column = "Zeit"
unit = "ms"
[motor_speed_rad_s]
column = "n_EM"
unit = "rpm"
sign = -1
[wheel_speed_rad_s]
column = "n_Rad"
unit = "rpm"
"""
RPM = 60 / (2 * np.pi)


def model() -> Path:
    return SIM.source.parent / "three_inertia.toml"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A log of another tool: the shipped axle under a multisine, with other names, units and one sign."""
    rng = np.random.default_rng(5)
    time_s = np.arange(8000) * 1e-3
    lines = rng.choice(np.arange(4, 120), 30, replace=False) / 8.0
    torque = 20 + sum(3 * np.sin(2 * np.pi * hz * time_s + rng.uniform(0, 6)) for hz in lines)
    asked = {"time_s": np.asarray(time_s), "motor_torque_ref_nm": torque}
    found = replay(load_model(model()), Recording(asked, tmp_path))
    rows = zip(
        time_s * 1e3,
        torque,
        -found["motor_speed_rad_s"] * RPM,
        found["wheel_speed_rad_s"] * RPM,
        found["shaft_torque_nm"],
        strict=True,
    )
    text = "".join(";".join(f"{cell:.9g}".replace(".", ",") for cell in row) + "\n" for row in rows)
    (tmp_path / "log.txt").write_text("Prüfstand 7\nZeit;M_soll;n_EM;n_Rad;M_welle\n" + text, "utf-8")
    (tmp_path / "columns.toml").write_text(COLUMNS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def printed_json(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert guarded([*arguments, "--json"]) == 0, capsys.readouterr().err
    return json.loads(capsys.readouterr().out)


def test_export_simulate_and_report_take_the_same_map(folder: Path, capsys) -> None:
    given = ("--columns", "columns.toml")
    exported = printed_json(capsys, "export", "log.txt", *given, "--out", "own.csv")
    speed = exported["read"]["log.txt"]["columns"]["motor_speed_rad_s"]
    assert (speed["column"], speed["unit"], speed["sign"]) == ("n_EM", "rpm", -1)
    own = read_recording(folder / "own.csv")
    simulated = printed_json(
        capsys, "simulate", "--model", str(model()), "--input", "log.txt", *given, "--out", "sim.csv"
    )
    assert simulated["read"] == exported["read"]
    found = read_recording(folder / "sim.csv")
    np.testing.assert_allclose(found["motor_speed_rad_s"], own["motor_speed_rad_s"], atol=1e-3)
    reported = printed_json(capsys, "report", "log.txt", *given, "--out", "report")
    assert reported["read"] == exported["read"]
    assert guarded(["export", "log.txt", *given, "--out", "again.csv"]) == 0
    printed = capsys.readouterr().out
    assert "'motor_speed_rad_s' is column 'n_EM', converted from rpm to rad/s, sign -1" in printed
    assert "numbers have a decimal comma" in printed


@pytest.mark.slow
def test_identify_and_diagnose_take_the_same_map(folder: Path, capsys) -> None:
    options = ("--columns", "columns.toml", "--columns", "wheel_speed_rad_s=n_Rad, unit=rpm")
    found = printed_json(capsys, "identify", "log.txt", *options, "--out", "id")
    assert found["read"]["log.txt"]["columns"]["motor_speed_rad_s"]["unit"] == "rpm"
    assert json.loads((folder / "id/identification.json").read_text()) == found
    diagnosed = printed_json(capsys, "diagnose", "--model", str(model()), "log.txt", *options, "--out", "why")
    assert diagnosed["read"] == found["read"]
    sentence = "'motor_speed_rad_s' is column 'n_EM', converted from rpm to rad/s, sign -1"
    for report in ("id/report.html", "why/report.html"):
        assert sentence in html.unescape((folder / report).read_text())


def test_a_map_that_does_not_fit_is_one_message_and_leaves_nothing(folder: Path, capsys) -> None:
    before = sorted(folder.iterdir())
    assert guarded(["export", "log.txt", "--columns", "motor_speed_rad_s=n_EN", "--out", "own.csv"]) == 2
    reported = capsys.readouterr().err
    assert "has no column" in reported or "no line names" in reported
    assert guarded(["identify", "log.txt", "--columns", "nowhere.toml", "--out", "id"]) == 2
    assert "nowhere.toml" in capsys.readouterr().err
    assert sorted(folder.iterdir()) == before


DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 291 Drive: 4 A
 SG_ n_EM : 0|16@1- (1,0) [0|0] "rpm" A
 SG_ M_soll : 16|16@1- (0.1,0) [0|0] "Nm" A
"""


def test_signals_of_a_dbc_become_channels(folder: Path, capsys) -> None:
    frames = [f"({1.7e9 + 0.01 * k:.6f}) can0 123#{600 + k:04X}{k:04X}\n" for k in range(200)]
    (folder / "a.log").write_text("".join(frames))
    (folder / "a.dbc").write_text(DBC.replace("0|16@1-", "7|16@0-").replace("16|16@1-", "23|16@0-"))
    given = ("--columns", "motor_speed_rad_s=n_EM, sign=-1", "--columns", "motor_torque_ref_nm=M_soll")
    done = printed_json(capsys, "replay", "a.log", "--dbc", "a.dbc", *given, "--out", "out")
    assert done["channels"] == ["time_s", "motor_speed_rad_s", "motor_torque_ref_nm"]
    assert done["columns"]["motor_speed_rad_s"] == {"column": "n_EM", "unit": "rpm", "sign": -1.0}
    found = read_recording(folder / "out/recording.mcap")
    np.testing.assert_allclose(found["motor_speed_rad_s"], -(600 + np.arange(200)) / RPM)
    assert guarded(["replay", "a.log", "--bench", "sim", *given, "--out", "o2"]) == 2
    assert "--columns goes with --dbc" in capsys.readouterr().err
    plain = printed_json(capsys, "replay", "a.log", "--dbc", "a.dbc", "--out", "plain")
    assert plain["channels"] == ["time_s", "n_EM", "M_soll"]
    later = printed_json(capsys, "export", "plain/recording.mcap", *given, "--out", "later.csv")
    assert later["read"]["plain/recording.mcap"]["columns"]["motor_speed_rad_s"]["unit"] == "rpm"
    np.testing.assert_allclose(
        read_recording(folder / "later.csv")["motor_speed_rad_s"][5], -605 / RPM, rtol=1e-8
    )
