"""MAT files as MATLAB users have them: variables, one structure, other things beside, and broken ones."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import loadmat, savemat

from hil.core.errors import BadInputError
from hil.core.recording import Recording, _mat, read_recording, write_recording

TIME = np.arange(100) / 1000
CHANNELS = {"time_s": TIME, "motor_torque_ref_nm": np.sin(TIME), "motor_speed_rad_s": np.cos(TIME)}


def saved(path: Path, **variables: Any) -> Path:
    savemat(path, variables, long_field_names=True)
    return path


@pytest.mark.parametrize("shape", [(-1, 1), (1, -1)])
def test_vectors_may_stand_or_lie_and_be_whole_numbers(tmp_path: Path, shape: tuple[int, int]) -> None:
    counted = np.arange(100, dtype=np.int16)
    vectors = {name: values.reshape(shape) for name, values in (CHANNELS | {"count": counted}).items()}
    read = read_recording(saved(tmp_path / "r.mat", **vectors))
    for name, values in CHANNELS.items():
        assert np.array_equal(read[name], values)
    assert read["count"].dtype == np.float64


def test_one_structure_may_hold_them(tmp_path: Path) -> None:
    read = read_recording(saved(tmp_path / "r.mat", run=CHANNELS, comment="cold"))
    assert np.array_equal(read["motor_speed_rad_s"], CHANNELS["motor_speed_rad_s"])


def test_what_is_no_vector_or_of_another_length_is_left_out_and_said(tmp_path: Path) -> None:
    others = {"title": "a day", "matrix": np.eye(3), "short": np.zeros(5), "phasor": 1j * TIME}
    read = read_recording(saved(tmp_path / "r.mat", **CHANNELS, **others))
    assert {*read.channels} == {*CHANNELS}
    assert {note.split("'")[1] for note in read.notes} == {*others}


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"motor_speed_rad_s": 1j * TIME}, "not a vector of real numbers"),
        ({"motor_speed_rad_s": np.zeros(5)}, "has 5 values, time_s has 100"),
        ({"time_s": "now"}, "not a vector of real numbers"),
    ],
)
def test_a_channel_that_is_none_is_refused_by_name(
    tmp_path: Path, changed: dict[str, Any], says: str
) -> None:
    with pytest.raises(BadInputError, match=says) as caught:
        read_recording(saved(tmp_path / "r.mat", **(CHANNELS | changed)))
    assert f"variable '{next(iter(changed))}'" in str(caught.value)


@pytest.mark.parametrize("before", [b"", b"MATLAB 7.3 MAT-file".ljust(512)])
def test_version_7_3_is_read_as_the_hdf5_that_it_is(tmp_path: Path, before: bytes) -> None:
    (tmp_path / "r.mat").write_bytes(before + b"\x89HDF\r\n\x1a\n" + bytes(100))
    with pytest.raises(BadInputError, match=r"HDF5") as caught:
        read_recording(tmp_path / "r.mat")
    if importlib.util.find_spec("h5py") is None:
        assert "eaxle-hil[hdf5]" in str(caught.value)
        assert "-v7" in str(caught.value)


def test_units_and_names_are_matlabs(tmp_path: Path) -> None:
    own = {"2nd sensor (V)": TIME, "a" * 80: TIME}
    write_recording(Recording(CHANNELS | own, Path("memory")), tmp_path / "r.mat")
    held = loadmat(tmp_path / "r.mat")
    assert held["motor_speed_rad_s"].shape == (100, 1)
    assert held["units"]["motor_speed_rad_s"][0, 0][0] == "rad/s"
    assert {"x2nd_sensor__V_", "a" * 63} <= {*held}
    twice = Recording(CHANNELS | {"a b": TIME, "a_b": TIME}, Path("memory"))
    with pytest.raises(BadInputError, match="one name in MATLAB"):
        write_recording(twice, tmp_path / "twice.mat")
    assert not (tmp_path / "twice.mat").exists()


@given(st.data())
@settings(max_examples=150, deadline=None)
def test_damaged_files_are_recordings_or_bad_input(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.mat"
    compressed = data.draw(st.booleans())
    savemat(path, CHANNELS | {"units": {"time_s": "s"}}, do_compression=compressed)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 8))] = data.draw(st.binary(max_size=8))
    path.write_bytes(bytes(content))
    try:
        read_recording(path)
    except BadInputError as error:
        assert "damaged.mat" in str(error)


def test_what_would_not_fit_into_memory_is_refused_before_it_is_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.mat"
    vectors = {"time_s": np.arange(300_000.0), "motor_torque_ref_nm": np.zeros(300_000)}
    savemat(path, vectors, do_compression=True)
    monkeypatch.setattr(_mat, "LARGEST_VALUES", 599_000)
    monkeypatch.setattr(_mat, "loadmat", None)  # it is not asked
    with pytest.raises(BadInputError, match=r"a\.mat: holds more than 0\.004792 GB, packed into 0\.\d+ MB"):
        read_recording(path)
