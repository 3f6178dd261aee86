"""HDF5 and TDMS: vectors, tables of pandas and waveforms as channels; what is none is named."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError, HilError
from hil.core.recording import column_map, read_recording

h5py = pytest.importorskip("h5py")
nptdms = pytest.importorskip("nptdms")

SECONDS = np.arange(100) * 1e-3
TORQUE = np.sin(SECONDS * 50)
MAP = column_map(["motor_torque_ref_nm=T", "motor_speed_rad_s=n, unit=rpm"])


def frame_of_pandas(path: Path, index: np.ndarray, **attributes: Any) -> Path:
    """As pandas writes `to_hdf(path, key="run", format="fixed")`: blocks of one type, items beside values."""
    with h5py.File(path, "w") as file:
        run = file.create_group("run")
        run["axis0"] = np.array([b"T", b"n"])
        run["axis1"] = index
        run["axis1"].attrs.update({name: np.bytes_(value) for name, value in attributes.items()})
        run["block0_items"] = np.array([b"T"])
        run["block0_values"] = TORQUE[:, None]
        run["block1_items"] = np.array([b"n"])
        run["block1_values"] = np.arange(100)[:, None]
    return path


@pytest.mark.parametrize(
    ("index", "attributes"),
    [
        (SECONDS, {"kind": "float", "name": "time_s"}),
        (1_704_067_200_000_000 + np.arange(100) * 1000, {"kind": "datetime64[us]", "name": "N."}),
        (np.arange(100) * 1_000_000, {"kind": "timedelta64", "name": "N."}),
    ],
)
def test_a_dataframe_of_pandas(index: np.ndarray, attributes: dict[str, str], tmp_path: Path) -> None:
    found = read_recording(frame_of_pandas(tmp_path / "r.h5", index, **attributes), columns=MAP)
    np.testing.assert_allclose(found.time_s, SECONDS, atol=1e-9)
    np.testing.assert_allclose(found["motor_torque_ref_nm"], TORQUE)
    np.testing.assert_allclose(found["motor_speed_rad_s"], np.arange(100) * 2 * np.pi / 60)


def test_an_index_of_moments_is_the_time_in_parquet_too(tmp_path: Path) -> None:
    index = pd.to_datetime("2024-01-01") + pd.to_timedelta(np.arange(100), unit="ms")
    pd.DataFrame({"T": TORQUE, "n": TORQUE + 5}, index=index).to_parquet(tmp_path / "r.parquet")
    found = read_recording(tmp_path / "r.parquet", columns=MAP)
    np.testing.assert_allclose(found.time_s, SECONDS, atol=1e-9)


def test_a_table_of_pytables_is_refused_with_what_to_write(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        run = file.create_group("run")
        run.attrs["pandas_type"] = np.bytes_("frame_table")
        run["table"] = np.zeros(3, [("index", "f8"), ("values_block_0", "f8", (2,))])
    with pytest.raises(BadInputError, match="format='table'") as caught:
        read_recording(tmp_path / "r.h5", columns=MAP)
    assert 'format="fixed"' in str(caught.value)


def test_vectors_with_units_and_a_structure_of_matlab(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["log/time_s"] = SECONDS[None, :]  # a column of MATLAB
        file["log/T"] = TORQUE[None, :] / 1000
        file["log/T"].attrs["units"] = "kN m"
        file["log/n"] = np.arange(100.0)
        file["log/name"] = np.bytes_("x")
        file["log/elsewhere"] = h5py.ExternalLink("/etc/passwd", "x")
    found = read_recording(tmp_path / "r.h5", columns=MAP)
    np.testing.assert_allclose(found["motor_torque_ref_nm"], TORQUE, atol=1e-12)
    assert "'log/elsewhere' is a link and was left out" in found.notes
    assert any("'log/name' is not a vector" in note for note in found.notes)


def test_a_table_of_records(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        records = np.zeros(100, [("time_s", "f8"), ("T", "f4"), ("n", "i4")])
        records["time_s"], records["T"] = SECONDS, TORQUE
        file["run"] = records
    np.testing.assert_allclose(read_recording(tmp_path / "r.h5", columns=MAP).time_s, SECONDS)


def tdms_of(path: Path, *channels: tuple[str, str, np.ndarray, dict[str, Any]]) -> Path:
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject(group, name, values, properties=reported)
                for group, name, values, reported in channels
            ]
        )
    return path


def test_waveforms_of_two_rates_come_to_the_inputs_stamps(tmp_path: Path) -> None:
    fast, slow = {"wf_increment": 1e-3, "unit_string": "kN m"}, {"wf_increment": 2e-3, "unit_string": "rpm"}
    path = tdms_of(
        tmp_path / "r.tdms",
        ("fast", "T", TORQUE / 1000, fast),
        ("slow", "n", np.arange(60.0), slow),
        ("slow", "note", np.array(["a"] * 60), {}),
    )
    found = read_recording(path, columns=column_map(["motor_torque_ref_nm=T", "motor_speed_rad_s=n"]))
    np.testing.assert_allclose(found.time_s, SECONDS)
    np.testing.assert_allclose(found["motor_torque_ref_nm"], TORQUE, atol=1e-12)
    np.testing.assert_allclose(found["motor_speed_rad_s"], SECONDS / 2e-3 * 2 * np.pi / 60, atol=1e-12)
    assert "'motor_speed_rad_s' was interpolated at the time stamps of 'motor_torque_ref_nm'" in found.notes
    assert "channel 'slow/note' is not numeric and was left out" in found.notes


def test_a_column_of_moments_is_time(tmp_path: Path) -> None:
    moments = np.datetime64("2024-01-01T00:00:00") + (np.arange(100) * 1000).astype("timedelta64[us]")
    path = tdms_of(
        tmp_path / "r.tdms", ("g", "time_s", moments, {}), ("g", "T", TORQUE, {}), ("g", "n", TORQUE, {})
    )
    np.testing.assert_allclose(read_recording(path, columns=MAP).time_s, SECONDS, atol=1e-6)


@given(st.sampled_from([".h5", ".tdms"]), st.integers(0, 1 << 30), st.binary(min_size=1, max_size=8))
def test_damaged_files_are_refused_or_read(
    tmp_path_factory, ending: str, place: int, bytes_there: bytes
) -> None:
    path = tmp_path_factory.mktemp("damaged") / f"r{ending}"
    if ending == ".h5":
        frame_of_pandas(path, SECONDS, kind="float", name="time_s")
    else:
        tdms_of(path, ("g", "T", TORQUE, {"wf_increment": 1e-3}), ("g", "n", TORQUE, {"wf_increment": 1e-3}))
    content = bytearray(path.read_bytes())
    place %= len(content)
    content[place : place + len(bytes_there)] = bytes_there
    path.write_bytes(bytes(content))
    with contextlib.suppress(HilError):
        read_recording(path, columns=MAP)


def test_a_dataset_that_only_promises_is_refused_before_it_is_held(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file.create_dataset("time_s", (200_000_000,), "f8", chunks=(1000,))
    with pytest.raises(BadInputError, match="HDF5"):
        read_recording(tmp_path / "r.h5")


def test_a_file_that_was_cut_says_so(tmp_path: Path) -> None:
    path = tdms_of(tmp_path / "r.tdms", ("g", "T", TORQUE, {"wf_increment": 1e-3}), ("g", "n", TORQUE, {}))
    path.write_bytes(path.read_bytes()[:-80])
    with pytest.raises(BadInputError, match=r"has \d+ values, time_s has 100"):
        read_recording(path, columns=MAP)
