"""Columns of other tools as channels: what a map states is done, reported and kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF, Signal
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from hil.core.errors import BadInputError
from hil.core.recording import Recording, column_map, columns_of, read_recording, write_recording

SECONDS = np.arange(200) * 1e-3
TORQUE = 50 * np.sin(SECONDS * 20)
RPM = 1000 + 100 * np.cos(SECONDS * 20)
RAD_S = RPM * 2 * np.pi / 60
OPTIONS = ("time_s=t, unit=ms", "motor_torque_ref_nm=T_req", "motor_speed_rad_s=n_EM, unit=rpm, sign=-1")
TABLE = {"t": SECONDS * 1e3, "T_req": TORQUE, "n_EM": -RPM}


def csv_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    rows = zip(*table.values(), strict=True)
    lines = [",".join(table), *(",".join(repr(float(cell)) for cell in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def parquet_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    pq.write_table(pa.table(table), path)
    return path


def mat_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    savemat(path, table)
    return path


def mat_structure_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    savemat(path, {"logged": table})
    return path


def mdf_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    with MDF(version="4.10") as mdf:
        mdf.append([Signal(values, SECONDS, name=name) for name, values in table.items()])
        mdf.save(path, overwrite=True)
    return path


def hdf5_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name, values in table.items():
            file[f"run 1/{name}"] = values
    return path


def tdms_of(path: Path, table: dict[str, np.ndarray]) -> Path:
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([nptdms.ChannelObject("run", name, values) for name, values in table.items()])
    return path


WRITERS = {
    "r.csv": csv_of,
    "r.txt": csv_of,
    "r.parquet": parquet_of,
    "v.mat": mat_of,
    "s.mat": mat_structure_of,
    "r.mf4": mdf_of,
    "r.h5": hdf5_of,
    "r.tdms": tdms_of,
}


@pytest.mark.parametrize("name", WRITERS)
def test_one_map_serves_every_kind_of_file(name: str, tmp_path: Path) -> None:
    found = read_recording(WRITERS[name](tmp_path / name, TABLE), columns=column_map(OPTIONS))
    np.testing.assert_allclose(found.time_s, SECONDS, atol=1e-12)
    np.testing.assert_allclose(found["motor_torque_ref_nm"], TORQUE)
    np.testing.assert_allclose(found["motor_speed_rad_s"], RAD_S, rtol=1e-12)
    speed = columns_of(found)["motor_speed_rad_s"]
    assert (speed["column"], speed["unit"], speed["sign"]) == ("n_EM", "rpm", -1.0)
    assert "'motor_speed_rad_s' is column 'n_EM', converted from rpm to rad/s, sign -1" in found.notes
    guess = "'motor_torque_ref_nm' is column 'T_req', which names no unit: it was taken to be in N m"
    assert guess in found.notes
    assert columns_of(found)["motor_torque_ref_nm"]["unit_guessed"]


def test_a_file_says_the_same_as_options(tmp_path: Path) -> None:
    file = tmp_path / "columns.toml"
    file.write_text(
        'motor_torque_ref_nm = "T_req"\n[time_s]\ncolumn = "t"\nunit = "ms"\n'
        '[motor_speed_rad_s]\ncolumn = "n_EM"\nunit = "rpm"\nsign = -1\n'
    )
    assert column_map([str(file)]) == column_map(OPTIONS)
    later = column_map([str(file), "motor_speed_rad_s=n2"])
    assert later.sources["motor_speed_rad_s"].column == "n2"
    assert later.sources["time_s"].unit == "ms"


@pytest.mark.parametrize(
    ("option", "reported"),
    [
        ("motor_speed_rads=n", "'motor_speed_rads' is no channel"),
        ("motor_speed_rads=n", "did you mean 'motor_speed_rad_s'"),
        ("motor_speed_rad_s", "has no '='"),
        ("motor_speed_rad_s=", "has no column"),
        ("motor_speed_rad_s=n, unit=Nm", "is in 'Nm', not in rad/s"),
        ("motor_speed_rad_s=n, unit=wuzzle", "no unit that is known"),
        ("motor_speed_rad_s=n, sign=2", "sign is '2"),
        ("motor_speed_rad_s=n, scale=x", "scale is 'x'"),
        ("motor_speed_rad_s=n, scale=nan", "scale is 'nan'"),
        ("motor_speed_rad_s=n, gear=0", "gear is 0"),
        ("motor_speed_rad_s=n, wraps=-1", "wraps is -1"),
        ("motor_speed_rad_s=n, derivative=maybe", "true or false"),
        ("motor_speed_rad_s=n, every_s=1", "every_s goes with time_s"),
        ("motor_speed_rad_s=n, missing=x", "missing is 'x'"),
    ],
)
def test_an_option_that_means_nothing_is_refused(option: str, reported: str) -> None:
    with pytest.raises(BadInputError) as caught:
        column_map([option])
    assert reported in str(caught.value)


def test_all_mistakes_of_a_file_are_named_with_their_lines(tmp_path: Path) -> None:
    file = tmp_path / "columns.toml"
    file.write_text('[time_s]\ncolumn = "t"\nunits = "ms"\n[speed]\ncolumn = "n"\n')
    with pytest.raises(BadInputError) as caught:
        column_map([str(file)])
    assert "2 mistakes" in str(caught.value)
    assert "line 4" in str(caught.value)
    assert "did you mean 'unit'" in str(caught.value)


def test_one_column_cannot_be_two_channels() -> None:
    with pytest.raises(BadInputError, match="both 'motor_torque_ref_nm' and 'motor_torque_nm'"):
        column_map(["motor_torque_ref_nm=T", "motor_torque_nm=T"])


def read(tmp_path: Path, table: dict[str, np.ndarray], *options: str) -> Recording:
    return read_recording(csv_of(tmp_path / "r.csv", table), columns=column_map(options))


def test_scale_offset_and_gear_apply_in_this_order(tmp_path: Path) -> None:
    table = {"time_s": SECONDS, "T": TORQUE, "raw": RPM / 2 + 7, "Ts": TORQUE}
    found = read(
        tmp_path,
        table,
        "motor_torque_ref_nm=T, unit=N m",
        "wheel_speed_rad_s=raw, unit=rpm, scale=2, offset=-14, gear=8",
        "shaft_torque_nm=Ts, unit=kN m, gear=8",
    )
    np.testing.assert_allclose(found["wheel_speed_rad_s"], RAD_S / 8, rtol=1e-12)
    np.testing.assert_allclose(found["shaft_torque_nm"], TORQUE * 8e3, rtol=1e-12)


def test_a_position_that_wraps_gives_its_speed(tmp_path: Path) -> None:
    turned = np.cumsum(RPM) / 60 * 1e-3 * 4096
    table = {"time_s": SECONDS, "T": TORQUE, "pos": np.mod(turned, 4096)}
    source = "motor_speed_rad_s=pos, wraps=4096, scale=0.0015339807878856412, unit=rad, derivative=true"
    found = read(tmp_path, table, "motor_torque_ref_nm=T", source)
    inner = slice(1, -1)
    expected = (RAD_S[1:-1] + RAD_S[2:]) / 2  # what a central difference of the sum is
    np.testing.assert_allclose(found["motor_speed_rad_s"][inner], expected, rtol=1e-9)
    with pytest.raises(BadInputError, match="derivative=true"):
        column_map(["wheel_speed_rad_s=pos, unit=rad"])
    table["pos [deg]"] = table.pop("pos")
    with pytest.raises(BadInputError, match="derivative=true"):
        read(tmp_path, table, "motor_torque_ref_nm=T", "motor_speed_rad_s=pos")


@pytest.mark.parametrize(
    ("name", "per_s", "row"), [("time_ms", 1e3, ""), ("time [ms]", 1e3, ""), ("time", 1e3, "ms,,\n")]
)
def test_units_beside_a_map_are_converted_all_the_same(
    name: str, per_s: float, row: str, tmp_path: Path
) -> None:
    path = csv_of(tmp_path / "r.csv", {name: SECONDS * per_s, "T": TORQUE, "motor_speed_rad_s [rpm]": RPM})
    header, _, body = path.read_text().partition("\n")
    path.write_text(f"{header}\n{row}{body}")
    found = read_recording(path, columns=column_map(["motor_torque_ref_nm=T"]))
    np.testing.assert_allclose(found.time_s, SECONDS, atol=1e-12)
    np.testing.assert_allclose(found["motor_speed_rad_s"], RAD_S)
    assert "'time_s' was converted from ms to s" in found.notes


def test_time_may_be_counted(tmp_path: Path) -> None:
    found = read(
        tmp_path,
        {"T": TORQUE, "n": RPM},
        "time_s=, every_s=0.002",
        "motor_torque_ref_nm=T",
        "motor_speed_rad_s=n",
    )
    np.testing.assert_allclose(found.time_s, SECONDS * 2)
    assert "time was counted: a sample every 0.002 s" in found.notes


def test_cells_that_mean_nothing_are_missing(tmp_path: Path) -> None:
    speed = RPM.copy()
    speed[77] = -9999
    table = {"time_s": SECONDS, "T": TORQUE, "n": speed}
    options = ("motor_torque_ref_nm=T", "motor_speed_rad_s=n, unit=rpm")
    with pytest.raises(BadInputError, match="missing=-9999") as caught:
        read(tmp_path, {"time_s": SECONDS, "motor_torque_ref_nm": TORQUE, "motor_speed_rad_s": speed})
    assert "column 'motor_speed_rad_s': is -9999 in 1 row, and within" in str(caught.value)
    with pytest.raises(BadInputError, match="missing=-9999"):
        read(tmp_path, table, *options)  # whatever the unit makes of it
    found = read(tmp_path, table, *options[:1], f"{options[1]}, missing=-9999")
    assert abs(found["motor_speed_rad_s"][77] - RAD_S[77]) < 0.1
    kept = read(tmp_path, table, *options[:1], f"{options[1]}, missing=")
    assert kept["motor_speed_rad_s"][77] < -1000


@pytest.mark.parametrize(
    ("header", "column"),
    [
        ("n_EM [rpm]", "n_EM"),
        ("N_EM", "n_EM"),
        ("Model Root/Drive/n_EM", "n_EM"),
        ("n_EM\\ETKC:1", "n_EM"),
        ("drive.n_EM", "n_EM"),
    ],
)
def test_a_column_is_found_by_the_part_of_its_name_that_people_use(
    header: str, column: str, tmp_path: Path
) -> None:
    table = {"time_s": SECONDS, "T": TORQUE, header: RPM}
    found = read(tmp_path, table, "motor_torque_ref_nm=T", f"motor_speed_rad_s={column}")
    assert columns_of(found)["motor_speed_rad_s"]["column"] == header
    if "[rpm]" in header:
        np.testing.assert_allclose(found["motor_speed_rad_s"], RAD_S)
    else:
        assert f"'{column}' was taken to be '{header}'" in found.notes


def test_two_columns_that_may_be_meant_are_refused_by_name(tmp_path: Path) -> None:
    table = {"time_s": SECONDS, "T": TORQUE, "left/n": RPM, "right/n": RPM}
    with pytest.raises(BadInputError, match="'left/n', 'right/n'"):
        read(tmp_path, table, "motor_torque_ref_nm=T", "motor_speed_rad_s=n")


def test_a_column_that_is_not_there_is_named_with_the_closest(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="did you mean 'n_EM'"):
        read(tmp_path, TABLE, *OPTIONS[:2], "motor_speed_rad_s=n_EN")


def test_the_map_comes_before_a_channel_of_the_same_name(tmp_path: Path) -> None:
    table = {"time_s": SECONDS, "motor_torque_ref_nm": TORQUE, "motor_speed_rad_s": 0 * RPM, "n": RPM}
    found = read(tmp_path, table, "motor_speed_rad_s=n, unit=rpm")
    np.testing.assert_allclose(found["motor_speed_rad_s"], RAD_S)
    assert any("'motor_speed_rad_s' was left out" in note for note in found.notes)


def test_what_was_understood_stays_with_an_export(tmp_path: Path) -> None:
    found = read(tmp_path, TABLE, *OPTIONS)
    write_recording(found, tmp_path / "e.parquet")
    again = read_recording(tmp_path / "e.parquet")
    assert columns_of(again) == columns_of(found)
    np.testing.assert_array_equal(again["motor_speed_rad_s"], found["motor_speed_rad_s"])


@given(
    st.sampled_from([-1, 1]),
    st.floats(1e-3, 1e3),
    st.floats(-1e3, 1e3),
    st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=40),
)
def test_a_map_undoes_what_another_tool_did(
    sign: int, scale: float, offset: float, values: list[float]
) -> None:
    import tempfile

    truth = np.array(values)
    raw = (sign * truth - offset) / scale
    table = {"time_s": np.arange(len(truth)) * 1e-3, "T": truth, "raw": raw}
    with tempfile.TemporaryDirectory() as folder:
        source = (
            f"motor_speed_rad_s=raw, unit=rad/s, sign={sign}, scale={scale!r}, offset={offset!r}, missing="
        )
        options = ("motor_torque_ref_nm=T, missing=", source)
        found = read_recording(csv_of(Path(folder) / "r.csv", table), columns=column_map(options))
    np.testing.assert_allclose(
        found["motor_speed_rad_s"], truth, atol=1e-6 * max(1.0, abs(offset)), rtol=1e-9
    )


def test_a_key_that_stands_twice_is_refused() -> None:
    with pytest.raises(BadInputError, match="unit stands twice"):
        column_map(["motor_speed_rad_s=n, unit=rpm, unit=rad/s"])


def test_a_range_that_its_cells_exceed_is_no_range_of_a_counter(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="wraps is 100, its cells go from"):
        read(tmp_path, TABLE, *OPTIONS[:2], "motor_speed_rad_s=n_EM, unit=rpm, wraps=100")


def test_a_pace_that_the_column_of_time_contradicts_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="the column of time goes over"):
        read(tmp_path, TABLE, "time_s=t, unit=ms, every_s=0.002", *OPTIONS[1:])
