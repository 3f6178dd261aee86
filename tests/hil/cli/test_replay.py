"""`hil replay` as a user calls it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hil.cli._app import guarded

DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 291 Fast: 2 A
 SG_ Speed : 0|16@1+ (0.1,0) [0|0] "km/h" A
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    lines = [f"({1.7e9 + 0.01 * k:.6f}) can0 123#{k:02X}00\n" for k in range(200)]
    (tmp_path / "a.log").write_text("".join(lines))
    (tmp_path / "a.dbc").write_text(DBC)
    return tmp_path


def test_a_log_and_a_dbc_give_a_recording_that_reports_and_exports(folder: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(folder)
    assert guarded(["replay", "a.log", "--dbc", "a.dbc", "--out", "out", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["verdict"], told["frames"], told["samples"]) == (None, 200, 200)
    assert told["channels"] == ["time_s", "Speed"]
    assert {path.name for path in (folder / "out").iterdir()} >= {
        "recording.mcap",
        "report.html",
        "report.pdf",
    }
    page = (folder / "out/report.html").read_text("utf-8")
    assert "Replay of a.log" in page
    assert "nothing is judged" in page
    assert "km/h" in page  # the DBC's unit
    assert guarded(["export", "out/recording.mcap", "--out", "out.csv"]) == 0
    assert (folder / "out.csv").read_text("utf-8").splitlines()[:2] == ["time_s,Speed", "0.0,0.0"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("a.log",), "either --bench or --dbc"),
        (("a.log", "--bench", "sim", "--dbc", "a.dbc"), "either --bench or --dbc"),
        (("a.log", "--dbc", "a.dbc", "--bus", "rmcu=can0"), "--bus goes with --bench"),
        (("a.log", "--bench", "sim", "--bus", "rmcu"), "write --bus NAME=VALUE"),
        (("a.log", "--dbc", "a.dbc", "--dbc", "b.dbc"), "given twice for all channels"),
        (("a.log", "a.log", "--dbc", "a.dbc"), "is given twice"),
        (("a.log", "--bench", "sim"), "no frame in the log belongs to a device"),
        (("a.dbc", "--dbc", "a.dbc"), "logs of frames end in"),
    ],
)
def test_a_mistake_is_one_message_and_leaves_nothing(
    folder: Path, arguments: tuple[str, ...], said: str, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(folder)
    assert guarded(["replay", *arguments]) == 2
    assert said in capsys.readouterr().err
    assert sorted(path.name for path in folder.iterdir()) == ["a.dbc", "a.log"]
