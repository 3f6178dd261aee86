"""What a notebook calls, and the blocks of its page."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hil import notebook
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from tests.docs.documented import ROOT

BLOCKS = re.findall(r"```python\n(.*?)```", (ROOT / "docs/how-to/notebook.md").read_text("utf-8"), re.DOTALL)
PLAN = """
name: short
variables:
  torque_nm: {default: 20, unit: N m, lower: 1, upper: 40}
steps:
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: $torque_nm, before_s: 0.2, after_s: 0.5}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 1, unit: N m}
"""


def test_a_frame_has_units_and_becomes_a_recording_again() -> None:
    channels = {"time_s": np.arange(5) / 10, "motor_speed_rad_s": np.arange(5.0), "own": np.zeros(5)}
    table = notebook.frame(Recording(channels, Path("r.csv")))
    assert table.index.name == "time_s"
    assert table.attrs["units"] == {"motor_speed_rad_s": "rad/s", "own": ""}
    again = notebook.recording_of(table)
    assert {name: values.tolist() for name, values in again.channels.items()} == {
        name: values.tolist() for name, values in channels.items()
    }


def test_a_frame_is_made_of_a_file_too(tmp_path: Path) -> None:
    names = ("time_s", "motor_torque_ref_nm", "motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
    rows = [",".join(names), *(f"{n / 10},0,{n + 1},0,0" for n in range(4))]
    (tmp_path / "r.csv").write_text("\n".join(rows) + "\n")
    for path in (tmp_path / "r.csv", str(tmp_path / "r.csv")):
        assert notebook.frame(path)["motor_speed_rad_s"].tolist() == [1.0, 2.0, 3.0, 4.0]


def test_a_column_of_words_is_refused_by_name() -> None:
    with pytest.raises(BadInputError, match="column 'word' is not numeric"):
        notebook.recording_of(pd.DataFrame({"word": ["a"]}, index=[0.0]), "mine")


@pytest.mark.slow
def test_a_run_gives_its_result_and_recording(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(PLAN)
    run = notebook.run(tmp_path / "short.yaml", tmp_path / "out", variables={"torque_nm": 10})
    assert (run.result.verdict, run.result.safe_state) == ("fail", "confirmed")
    assert run.result.variables[0].value == 10
    assert run.recording["shaft_torque_nm"].max() > 20.0
    with pytest.raises(BadInputError, match="torque_nm"):
        notebook.run(tmp_path / "short.yaml", tmp_path / "other", variables={"torque_nm": 500})
    assert not (tmp_path / "other").exists()


@pytest.mark.slow
def test_the_blocks_of_the_page_run_one_after_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in BLOCKS:
        exec(compile(block, "notebook.md", "exec"), names)
    found = names["diagnosis"]
    assert getattr(found, "verdict") in ("none", "named")  # noqa: B009
