from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.frequency_response import FrequencyResponse, frf_from_csv, frf_to_csv
from hil.core.errors import BadInputError


def test_table_is_read_back(tmp_path: Path, paper_frf: FrequencyResponse) -> None:
    path = tmp_path / "frf.csv"
    path.write_text(frf_to_csv(dataclasses.replace(paper_frf, input_hold_s=0.001)))
    assert frf_from_csv(path).input_hold_s == 0.001
    again = frf_from_csv(path)
    assert again.outputs == paper_frf.outputs
    assert again.independent_every == paper_frf.independent_every
    np.testing.assert_allclose(again.response, paper_frf.response, rtol=1e-7)
    np.testing.assert_allclose(again.standard_deviation, paper_frf.standard_deviation, rtol=1e-7)


def test_header_names_outputs_and_quantities(paper_frf: FrequencyResponse) -> None:
    header = frf_to_csv(paper_frf).splitlines()[0].split(",")
    assert header[0] == "frequency_hz"
    assert "motor_speed_rad_s.gain_db" in header
    assert "shaft_torque_nm.coherence" in header


@pytest.mark.parametrize("text", ["", "a,b\n1,2\n", "frequency_hz\n1\n", "frequency_hz,x\n1,abc\n"])
def test_other_tables_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "frf.csv"
    path.write_text(text)
    with pytest.raises(BadInputError):
        frf_from_csv(path)


def test_unknown_output(paper_frf: FrequencyResponse) -> None:
    with pytest.raises(KeyError):
        paper_frf.of("dyno_torque_ref_nm")
