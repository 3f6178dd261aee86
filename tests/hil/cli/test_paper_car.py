"""The shipped bench that gives the paper's peaks of shaft torque, as `hil run` and on the wire."""

import json

import pytest

from hil.cli._app import guarded

# section 4.3 of the paper, N m
PEAKS = {"gain_0kmh": 534.0, "gain_20kmh": 723.0, "phase_20kmh": 564.0}


@pytest.mark.slow
def test_its_peaks_are_the_papers_within_5_percent_and_in_the_papers_order(tmp_path, capsys):
    guarded(["run", "acceptance", "--bench", "paper_car", "--out", str(tmp_path / "out"), "--json"])
    result = json.loads(capsys.readouterr().out)
    values = {criterion["id"]: criterion for criterion in result["criteria"]}
    for segment, peak in PEAKS.items():
        assert values[f"{segment}.peak_shaft_torque"]["value"] == pytest.approx(peak, rel=0.05)
    for name, criterion in values.items():
        if ".below." in name:
            assert criterion["verdict"] == "pass", name
