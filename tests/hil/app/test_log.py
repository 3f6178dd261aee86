"""Logs: silent unless asked for, and kept when the program makes a mistake."""

import json
import logging
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from hil.app import schemas
from hil.app.log import LOG
from hil.cli._app import guarded

RECORDING = "time_s,motor_torque_ref_nm,motor_speed_rad_s\n" + "".join(f"{k / 10},1,2\n" for k in range(20))


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(RECORDING)
    return path


def test_a_command_says_nothing_unless_it_is_asked(recording, tmp_path, capsys):
    assert guarded(["export", str(recording), "--out", str(tmp_path / "x.parquet")]) == 0
    assert capsys.readouterr().err == ""


def test_verbose_tells_on_standard_error_and_leaves_json_alone(recording, tmp_path, capsys):
    assert guarded(["export", str(recording), "--out", str(tmp_path / "x.csv"), "--json", "--verbose"]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out)["samples"] == 20
    assert re.search(r"INFO hil\.core\.recording: read .*r\.csv: 20 samples", told.err)


def test_a_log_has_the_command_its_steps_and_its_end_and_may_be_written_again(recording, tmp_path, capsys):
    log = tmp_path / "log.txt"
    for out in ("x.csv", "y.csv"):
        assert guarded(["export", str(recording), "--out", str(tmp_path / out), "--log", str(log)]) == 0
    lines = log.read_text().splitlines()
    assert lines[0] == "# log of hil"
    assert "hil export" in lines[1]
    assert not any("x.csv" in line for line in lines)
    assert lines[-1].endswith("exit code 0")
    assert capsys.readouterr().err == ""


def test_nothing_but_a_log_is_written_over(recording, capsys):
    assert guarded(["schema", "--log", str(recording)]) == 2
    assert recording.read_text() == RECORDING
    assert "is not a log file" in capsys.readouterr().err
    assert guarded(["schema", "--log", str(recording.parent)]) == 2
    assert guarded(["schema", "--log", str(recording.parent / "nowhere" / "log")]) == 2


def test_a_users_mistake_is_in_the_log_and_makes_none(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert guarded(["schema", "plum"]) == 2
    assert list(tmp_path.iterdir()) == []
    assert guarded(["schema", "plum", "--log", str(tmp_path / "log")]) == 2
    assert "there is no schema for 'plum'" in (tmp_path / "log").read_text()
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("named", [True, False])
def test_a_mistake_of_the_program_leaves_its_traceback_in_a_log_and_says_where(
    named, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setitem(schemas.SCHEMAS, "plan", lambda: 1 / 0)
    assert guarded(["schema", *(["--log", str(tmp_path / "hil-own.log")] if named else [])]) == 3
    told = capsys.readouterr().err
    [log] = tmp_path.iterdir()
    assert "internal error: ZeroDivisionError" in told
    assert str(log) in told
    assert "Traceback" not in told
    assert "Traceback" in log.read_text()


def test_control_characters_of_a_name_do_not_reach_the_terminal(tmp_path, capsys):
    guarded(["export", str(tmp_path / "\x1b[31mred.csv"), "--out", str(tmp_path / "x.csv"), "--verbose"])
    assert "\x1b" not in capsys.readouterr().err


def test_a_command_leaves_no_handlers_behind(recording):
    before = list(logging.getLogger().handlers)
    guarded(["schema", "--verbose"])
    assert logging.getLogger().handlers == before


def test_what_a_library_warns_of_stands_in_the_log_and_not_on_the_terminal(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        LOG.begin(["hil", "x"])
        LOG.send(tmp_path / "log.txt", verbose=False)
        assert np.isnan(np.mean(np.zeros(0)))
        LOG.end()
    assert capfd.readouterr().err == ""
    assert "Mean of empty slice" in (tmp_path / "log.txt").read_text()
