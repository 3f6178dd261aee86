from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF
from hypothesis import given
from hypothesis import strategies as st

from hil.core.channels import unit_of
from hil.core.errors import BadInputError, HilError
from hil.core.recording import Recording, read_recording, write_recording

TIME = np.arange(200) / 1000
HEADER = "time_s,motor_torque_ref_nm,motor_speed_rad_s\n"


def recording() -> Recording:
    return Recording(
        {
            "time_s": TIME,
            "motor_torque_ref_nm": np.sin(TIME),
            "motor_speed_rad_s": np.cos(TIME),
            "own_channel": TIME**2,
        },
        Path("memory"),
    )


@pytest.mark.parametrize("ending", ["csv", "parquet", "mf4", "mat"])
def test_every_format_gives_back_what_was_written(ending, tmp_path):
    write_recording(recording(), tmp_path / f"r.{ending}")
    again = read_recording(tmp_path / f"r.{ending}")
    for name, values in recording().channels.items():
        np.testing.assert_allclose(again[name], values, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize(("ending", "stretch"), [("csv", "_csv_block._ROWS_AT_ONCE"), ("mf4", "mdf.BLOCK")])
def test_what_is_written_in_stretches_is_whole(ending, stretch, tmp_path, monkeypatch):
    monkeypatch.setattr(f"hil.core.recording.{stretch}", 64)  # 200 samples: three whole ones and a part
    write_recording(recording(), tmp_path / f"r.{ending}")
    again = read_recording(tmp_path / f"r.{ending}")
    for name, values in recording().channels.items():
        np.testing.assert_allclose(again[name], values, rtol=1e-8, atol=1e-12)


def test_a_recording_of_times_alone_is_written(tmp_path):
    write_recording(Recording({"time_s": TIME}, Path("memory")), tmp_path / "r.csv")
    assert (tmp_path / "r.csv").read_text().splitlines()[:3] == ["time_s", "0.0", "0.001"]


def test_a_channel_that_is_not_there_is_told_with_those_that_are():
    with pytest.raises(BadInputError) as caught:
        recording()["oil_temperature_k"]
    assert caught.value.fix == (
        "it has: time_s, motor_torque_ref_nm, motor_speed_rad_s, own_channel; "
        "state which it is: --columns 'oil_temperature_k=COLUMN, unit=…'"
    )
    with pytest.raises(BadInputError, match="it has: none"):
        Recording({}, Path("memory"))["time_s"]


def test_csv_is_read_by_pandas(tmp_path):
    write_recording(recording(), tmp_path / "r.csv")
    frame = pd.read_csv(tmp_path / "r.csv")
    assert frame.columns[0] == "time_s"
    np.testing.assert_allclose(frame["motor_speed_rad_s"], np.cos(TIME), rtol=1e-8)


def test_parquet_is_read_by_pyarrow_with_units(tmp_path):
    write_recording(recording(), tmp_path / "r.parquet")
    schema = pq.read_schema(tmp_path / "r.parquet")
    assert schema.field("motor_speed_rad_s").metadata[b"unit"] == b"rad/s"


def test_mdf_is_read_by_asammdf_with_units(tmp_path):
    write_recording(recording(), tmp_path / "r.mf4")
    with MDF(tmp_path / "r.mf4") as mdf:
        signal = mdf.get("motor_torque_ref_nm")
        assert signal.unit == "N m"
        np.testing.assert_allclose(signal.samples, np.sin(TIME))
        np.testing.assert_allclose(signal.timestamps, TIME)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "line 1"),
        ("0,1,2\n0.1,1,2\n", "line 1"),
        (HEADER + "0,1,2\n0.001,x,2\n", "line 3, column 'motor_torque_ref_nm'"),
        (HEADER + "0,1,2\n0.001,1,2\n0.0005,1,2\n", "sample 3"),
        (HEADER + "0,1,2\n", "1 samples"),
        (HEADER + "0,1,nan\n0.001,1,2\n", "'motor_speed_rad_s'"),
        (HEADER + "0,1,inf\n0.001,1,2\n", "'motor_speed_rad_s'"),
        ("time_s,motor_torque_ref_nm\n0,1\n0.001,1\n", "none of the output channels"),
        ("time_s,motor_speed_rad_s\n0,1\n0.001,1\n", "motor_torque_ref_nm"),
        ("time_s,motor_torque_ref_nm,motor_torque_ref_nm\n0,1,2\n", "twice"),
    ],
)
def test_a_csv_that_cannot_be_used_is_refused_with_its_place(text, said, tmp_path):
    (tmp_path / "r.csv").write_text(text)
    with pytest.raises(BadInputError) as caught:
        read_recording(tmp_path / "r.csv")
    assert said in str(caught.value)
    assert "r.csv" in str(caught.value)


def test_few_missing_cells_are_mended_and_said(tmp_path):
    rows = [f"{t:.3f},1,{'' if i == 50 else t}" for i, t in enumerate(TIME)]
    (tmp_path / "r.csv").write_text(HEADER + "\n".join(rows))
    read = read_recording(tmp_path / "r.csv")
    assert read["motor_speed_rad_s"][50] == pytest.approx(0.05)
    assert any("missing" in note for note in read.notes)


def test_columns_that_are_not_numbers_are_left_out_and_said(tmp_path):
    (tmp_path / "r.csv").write_text("time_s,motor_torque_ref_nm,motor_speed_rad_s,remark\n0,1,2,a\n1,1,2,b\n")
    read = read_recording(tmp_path / "r.csv")
    assert "remark" not in read
    assert any("remark" in note for note in read.notes)


@pytest.mark.parametrize("ending", ["csv", "parquet", "mf4", "mcap"])
@given(content=st.binary(max_size=200))
def test_any_bytes_are_a_recording_or_bad_input(ending, content, tmp_path_factory):
    path = tmp_path_factory.mktemp("fuzz") / f"r.{ending}"
    path.write_bytes(content)
    try:
        read_recording(path)
    except HilError as error:
        assert str(path) in str(error)


def test_a_file_that_is_not_there_is_told_in_the_systems_words(tmp_path):
    with pytest.raises(BadInputError) as caught:
        read_recording(tmp_path / "none.mcap")
    assert caught.value.what == "No such file or directory"


def test_a_missing_file_and_an_unknown_ending_say_so(tmp_path):
    with pytest.raises(BadInputError, match="No such file"):
        read_recording(tmp_path / "none.csv")
    with pytest.raises(BadInputError, match=r"\.mcap"):
        read_recording(tmp_path / "none.xlsx")


def test_an_export_to_a_directory_that_cannot_be_written_leaves_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInputError, match="--out"):
        write_recording(recording(), tmp_path / "file" / "r.csv")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file"]


def test_a_failed_runs_recording_can_still_be_reported(tmp_path):
    rows = [f"{t:.3f},1,{'' if i > 50 else t}" for i, t in enumerate(TIME)]
    (tmp_path / "r.csv").write_text(HEADER + "\n".join(rows))
    with pytest.raises(BadInputError, match="74.5%"):
        read_recording(tmp_path / "r.csv")
    read = read_recording(tmp_path / "r.csv", allow_missing=True)
    assert np.isnan(read["motor_speed_rad_s"][100])
    assert "missing" in read.notes[0]


def test_a_channel_that_is_not_in_the_table_has_the_unit_of_its_name() -> None:
    names = ("dyno_torque_left_nm", "wheel_speed_rad_s", "speed_m_s", "angle_rad", "delay_s", "count")
    assert [unit_of(name) for name in names] == ["N m", "rad/s", "m/s", "rad", "s", ""]


@pytest.mark.parametrize("ending", ["csv", "parquet", "mf4", "mat"])
def test_a_table_of_more_values_or_columns_than_are_read_at_once_is_refused(ending, tmp_path, monkeypatch):
    path = tmp_path / f"r.{ending}"
    write_recording(recording(), path)
    monkeypatch.setattr("hil.core.recording._table.LARGEST_VALUES", 799)  # it has 800
    with pytest.raises(BadInputError, match=r"has 200 rows of [34] columns, 6.4e-06 GB as numbers"):
        read_recording(path)
    monkeypatch.setattr("hil.core.recording._table.MOST_COLUMNS", 2)
    with pytest.raises(BadInputError, match=r"has [34] columns, at most 2 are read"):
        read_recording(path)


def test_rows_that_take_no_room_in_a_file_take_none_in_memory(tmp_path):
    path = tmp_path / "zeros.parquet"
    zeros = pa.table({name: pa.nulls(1 << 20, pa.int8()) for name in ("time_s", "motor_torque_ref_nm")})
    with pq.ParquetWriter(path, zeros.schema) as writer:
        for _ in range(400):
            writer.write_table(zeros)
    assert path.stat().st_size < 2e6
    with pytest.raises(BadInputError, match="has 419430400 rows of 2 columns, 6.71 GB as numbers"):
        read_recording(path)
