from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

import reports
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import write_figures, write_reports


def test_three_files_and_nothing_else(acceptance: dict[str, Path]) -> None:
    assert {name: path.name for name, path in acceptance.items()} == {
        "html": "report.html",
        "pdf": "report.pdf",
        "junit": "junit.xml",
    }
    directory = acceptance["html"].parent
    assert sorted(path.name for path in directory.iterdir()) == ["junit.xml", "report.html", "report.pdf"]


def test_a_foreign_recording_gets_statistics_and_no_verdict(recording: Recording, tmp_path: Path) -> None:
    recording.channels["all_missing"] = np.full(96_000, np.nan)
    foreign = Recording(recording.channels, Path("drive.csv"), notes=["3 cells were interpolated"])
    written = write_reports(foreign, None, tmp_path)
    assert set(written) == {"html", "pdf"}
    page = written["html"].read_text()
    assert "nothing is judged" in page
    assert "3 cells were interpolated" in page
    assert 'id="statistics"' in page
    assert "Tested by" not in page


@pytest.mark.parametrize("count", [0, 1, 2, 20])
def test_short_recordings_do_not_crash(count: int, result: RunResult, tmp_path: Path) -> None:
    short = Recording(
        {"time_s": np.arange(count) / 1000, "motor_torque_ref_nm": np.full(count, np.nan)}, Path("short.csv")
    )
    assert set(write_reports(short, result, tmp_path)) == {"html", "pdf", "junit"}


def test_nothing_is_written_if_one_form_cannot_be_made(
    recording: Recording, result: RunResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> bytes:
        raise RuntimeError("no PDF today")

    monkeypatch.setattr(reports, "pdf_bytes", fails)
    with pytest.raises(RuntimeError, match="no PDF today"):
        write_reports(recording, result, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_place_that_cannot_be_written_is_named(recording: Recording, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    recording.channels = {}
    with pytest.raises(BadInputError, match=r"directory|written") as caught:
        write_reports(recording, None, tmp_path / "file" / "out")
    assert str(tmp_path / "file") in caught.value.where


def test_figures_alone(recording: Recording, result: RunResult, tmp_path: Path) -> None:
    written = write_figures(recording, result, tmp_path)
    assert len(written) == 15
    assert ET.parse(written["steps-0kmh-shaft-torque"]).getroot().tag.endswith("svg")
