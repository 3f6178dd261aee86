"""CSV: what is read, what is refused with file, line and column, and how numbers are written."""

import re
import subprocess
import sys

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import Recording, _csv_reader, read_recording, write_recording

HEADER = "time_s,motor_torque_ref_nm,motor_speed_rad_s\n"
ROWS = HEADER + "0,1,2\n0.001,1,2\n"


def read(tmp_path, text: str | bytes) -> Recording:
    path = tmp_path / "r.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_recording(path)


@pytest.mark.parametrize(
    "text",
    [
        ROWS.replace("\n", "\r\n"),
        ROWS.replace("\n", "\r"),
        HEADER + "0,1,2\r\n0.001,1,2\n",
        "\ufeff" + ROWS,
        ROWS.removesuffix("\n"),
        ROWS + "\n\n  \n",
        HEADER + "\n0,1,2\n\n\n0.001,1,2\n",
        HEADER.replace(",", " , ") + " 0, 1 ,2\n 0.001 ,1, 2 \n",
        '"time_s","motor_torque_ref_nm","motor_speed_rad_s"\n"0","1","2"\n0.001,1,"2"\n',
    ],
)
def test_every_way_to_end_lines_and_to_quote_gives_the_same_table(text, tmp_path):
    table = read(tmp_path, text)
    assert table.time_s.tolist() == [0.0, 0.001]
    assert table["motor_torque_ref_nm"].tolist() == [1.0, 1.0]
    assert table["motor_speed_rad_s"].tolist() == [2.0, 2.0]
    assert table.notes == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        (HEADER, "0 samples"),
        (HEADER.removesuffix("\n"), "0 samples"),
        (HEADER + "0,1,2\n", "1 samples"),
        (ROWS.replace("time_s", "when"), "line 1: the header line has no 'time_s'"),
        (HEADER + "0,1,2\n\n\n0.001,x,2\n", "line 5, column 'motor_torque_ref_nm': 'x' is not a number"),
        (HEADER + "0,1,2\n\n\n0,1,2\n", "sample 2, line 5: 'time_s' does not increase"),
        (HEADER + "0,1,2\n\n,1,2\n", "sample 2, line 4: 'time_s' is not finite"),
        (HEADER + "0,1,2\n0.001,1\n", "line 3: has 2 cells, the header line names 3"),
        (HEADER + "0,1,2\n0.001,1,2,3\n", "line 3: has 4 cells"),
        (HEADER + "0,1,2\n0.001,1\x00,2\n", "line 3, column 'motor_torque_ref_nm'"),
        (HEADER + "0,1,2\n0.001,1_0,2\n", "'1_0' is not a number"),
        (HEADER + "0,1,2\n0.001,0x10,2\n", "'0x10' is not a number"),
        (HEADER + '0,1,2\n0.001,"1\n2",2\n', "line 3"),
        (
            HEADER.encode() + b"0,1,2\n0.001,1,\xff\n",
            "line 3, column 'motor_speed_rad_s': 'ÿ' is not a number",
        ),
        (HEADER.encode() + b"0,1,2\n0.001,1,\xff\x00\n", "line 3: not a text file"),
        (ROWS.encode("utf-16-le"), "line 1"),
        ("\ufeff".encode("utf-16-le") + ROWS.encode(), "line 1: the header line has no 'time_s'"),
        ("\x00" * 50, "line 1"),
        (
            HEADER + "0,1,2\n0.001,1e308,2\n",
            "line 3, column 'motor_torque_ref_nm': 1e+308 is not a plausible measurement",
        ),
        (
            HEADER + "0,1,2\n0.001,1,-2e15\n",
            "line 3, column 'motor_speed_rad_s': -2e+15 is not a plausible measurement",
        ),
        (HEADER + "0,1,2\n0.001,1e999,2\n", "line 3, column 'motor_torque_ref_nm': '1e999' is beyond"),
        (HEADER + "0,1,2\n1e16,1,2\n", "line 3, column 'time_s'"),
    ],
)
def test_what_cannot_be_used_is_refused_with_its_line(text, said, tmp_path):
    with pytest.raises(BadInputError) as caught:
        read(tmp_path, text)
    assert said in str(caught.value)
    assert "r.csv" in str(caught.value)


@pytest.mark.parametrize("start", [b"", HEADER.encode() + b"0,1,2\n"])
def test_a_line_without_end_is_refused_before_it_fills_the_memory(start, tmp_path):
    with pytest.raises(BadInputError, match=f"line {start.count(bytes([10])) + 1}: is longer than"):
        read(tmp_path, start + b"7" * (20 << 20))


def test_lines_and_columns_are_right_in_every_block_of_a_long_file(tmp_path, monkeypatch):
    monkeypatch.setattr(_csv_reader, "_BLOCK_BYTES", 64)
    monkeypatch.setattr(_csv_reader, "_LONGEST_LINE_BYTES", 64)
    rows = [f"{i / 1000},{i},{2 * i},{'text' if i == 30 else i}" for i in range(200)]
    header = HEADER.strip() + ",remark"
    table = read(tmp_path, "\r\n".join([header, *rows]))
    np.testing.assert_array_equal(table["motor_torque_ref_nm"], np.arange(200))
    assert "remark" not in table
    assert len(table.notes) == 1
    rows[150] = "0.15,1,two,3"
    with pytest.raises(BadInputError, match="line 152, column 'motor_speed_rad_s'"):
        read(tmp_path, "\r\n".join([header, *rows]))


def test_missing_cells_are_missing_in_every_spelling(tmp_path):
    spellings = ["", " ", "nan", "NaN", "NA", "null", "inf", "-inf"]
    rows = [f"{i / 1000},1,2,{spelling}" for i, spelling in enumerate(spellings)]
    table = read(tmp_path, HEADER.strip() + ",own\n" + "\n".join(rows))
    assert not np.isfinite(table["own"]).any()


def test_columns_without_a_name_are_left_out_and_said(tmp_path):
    table = read(tmp_path, HEADER.strip() + ",,\n0,1,2,,\n0.001,1,2,,5\n")
    assert list(table.channels) == HEADER.strip().split(",")
    assert table.notes == ["column 4 has no name and was left out", "column 5 has no name and was left out"]


def written(tmp_path, **channels: list[float]) -> list[str]:
    table = Recording({name: np.array(values) for name, values in channels.items()}, tmp_path)
    write_recording(table, tmp_path / "w.csv")
    return (tmp_path / "w.csv").read_text().splitlines()


def test_decimal_numbers_are_written_as_such_in_every_row(tmp_path):
    values = [1.0, 0.0, -3.0, 1e20, 123456789012.0, 1e-7, 0.1, 1 / 3, np.nan]
    lines = written(tmp_path, time_s=list(range(len(values))), motor_torque_ref_nm=values)
    assert lines[0] == "time_s,motor_torque_ref_nm"
    cells = [line.split(",") for line in lines[1:]]
    assert [time for time, _ in cells] == [f"{i}.0" for i in range(len(values))]
    assert all(re.fullmatch(r"-?\d+\.\d+(e[+-]\d+)?", cell) for _, cell in cells[:-1])
    assert cells[-1][1] == ""
    for (_, cell), value in zip(cells[:-1], values, strict=False):
        assert float(cell) == float(f"{value:.9g}")


def test_nine_digits_are_kept_whatever_the_magnitude(tmp_path):
    rng = np.random.default_rng(0)
    values = rng.standard_normal(2000) * 10.0 ** rng.integers(-40, 40, 2000)
    lines = written(tmp_path, time_s=list(range(2000)), own=values.tolist())
    assert [float(line.split(",")[1]) for line in lines[1:]] == [float(f"{value:.9g}") for value in values]


def test_time_keeps_its_nanoseconds_in_a_long_recording(tmp_path):
    time_s = [86_400.0001, 86_400.0002, 86_400.000_200_001]
    lines = written(tmp_path, time_s=time_s, own=[0.0, 0.0, 0.0])
    assert [line.split(",")[0] for line in lines[1:]] == ["86400.0001", "86400.0002", "86400.000200001"]


@pytest.mark.slow
def test_reading_and_writing_a_long_csv_takes_little_more_memory_than_its_channels(tmp_path):
    script = """
import resource, sys
from pathlib import Path
import numpy as np
from hil.core.recording import Recording, read_recording, write_recording
names = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"]
path = Path(sys.argv[1])
start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
write_recording(Recording({name: np.arange(1_000_000) / 7 for name in names}, path), path)
assert len(read_recording(path).time_s) == 1_000_000
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - start)
"""
    done = subprocess.run(
        [sys.executable, "-c", script, tmp_path / "r.csv"], capture_output=True, text=True, check=True
    )
    assert int(done.stdout) < 210_000  # kB; the channels alone are 40,000, twice
