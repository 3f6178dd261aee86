"""CSV of other tools and countries: read as it was meant and said, or refused; never wrongly in silence."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as arrow_csv
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.core.recording import Recording, read_recording

NAMES = ("time_s", "motor_torque_ref_nm", "motor_speed_rad_s")
TIME = np.arange(20) / 1000
TORQUE = np.linspace(-1.25, 2.5, 20)
SPEED = 1000 + np.arange(20) / 8


def text(
    separator: str = ",",
    comma: bool = False,
    names: tuple[str, ...] = NAMES,
    per_s: float = 1,
    second: str = "",
) -> str:
    rows = [separator.join(names), *([second] if second else [])]
    for row in zip(TIME * per_s, TORQUE, SPEED, strict=True):
        cells = [f"{value:.6f}".replace(".", "," if comma else ".") for value in row]
        rows.append(separator.join(cells))
    return "\n".join(rows) + "\n"


def read(tmp_path: Path, content: str | bytes) -> Recording:
    path = tmp_path / "r.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_recording(path)


def refused(tmp_path: Path, content: str | bytes) -> str:
    with pytest.raises(BadInputError) as caught:
        read(tmp_path, content)
    return str(caught.value)


def assert_is_meant(recording: Recording) -> None:
    np.testing.assert_allclose(recording.time_s, TIME, atol=1e-9)
    np.testing.assert_allclose(recording["motor_torque_ref_nm"], TORQUE, atol=1e-6)
    np.testing.assert_allclose(recording["motor_speed_rad_s"], SPEED, atol=1e-6)


IN_MS = ("time_ms", *NAMES[1:])
WITH_UNITS = ("time_s [s]", "motor_torque_ref_nm [Nm]", "motor_speed_rad_s (rad/s)")


@pytest.mark.parametrize(
    ("content", "notes"),
    [
        (text(), []),
        (text(";"), ["columns are separated by semicolons"]),
        (text("\t"), ["columns are separated by tabs"]),
        (text(";", comma=True), ["columns are separated by semicolons", "numbers have a decimal comma"]),
        (text("\t", comma=True), ["columns are separated by tabs", "numbers have a decimal comma"]),
        (text(names=tuple(f'"{name}"' for name in NAMES)), []),
        (text(";", names=tuple(f'"{name}"' for name in NAMES)), ["columns are separated by semicolons"]),
        (text(names=IN_MS, per_s=1e3), ["'time_ms' was converted from ms to s"]),
        (text(names=("time_us", *NAMES[1:]), per_s=1e6), ["'time_us' was converted from us to s"]),
        (text(names=("Time [ms]", *NAMES[1:]), per_s=1e3), ["'Time [ms]' was converted from ms to s"]),
        (text(names=WITH_UNITS), []),
        (text(second="s,N m,rad/s"), ["line 2 gives units"]),
        (text(second="[s],[Nm],"), ["line 2 gives units"]),
        (
            text(names=IN_MS, per_s=1e3, second="ms,Nm,rad/s"),
            ["'time_ms' was converted", "line 2 gives units"],
        ),
        (
            "\ufeff" + text(";", comma=True),
            ["columns are separated by semicolons", "numbers have a decimal comma"],
        ),
        ("sep=;\n" + text(";"), ["columns are separated by semicolons"]),
        ("SEP=,\r\n" + text().replace("\n", "\r\n"), []),
        (
            text(names=tuple(name.upper() for name in NAMES)),
            ["'TIME_S' was read as 'time_s', others"],
        ),
        (text(names=(NAMES[0], NAMES[1].title(), NAMES[2])), ["'Motor_Torque_Ref_Nm' was read as"]),
        (text().encode("utf-16"), []),
        (text().encode("utf-16-be").join([b"\xfe\xff", b""]), []),
        (text().replace("\n", "\r\n"), []),
    ],
    ids=str,
)
def test_what_is_beyond_doubt_is_read_as_it_was_meant_and_said(content, notes, tmp_path):
    recording = read(tmp_path, content)
    assert_is_meant(recording)
    assert len(recording.notes) == len(notes)
    assert all(found.startswith(said) for found, said in zip(recording.notes, notes, strict=True))


def test_what_pyarrow_writes_is_read(tmp_path):
    table = pa.table({"time_s": TIME, "motor_torque_ref_nm": TORQUE, "motor_speed_rad_s": SPEED})
    arrow_csv.write_csv(table, tmp_path / "r.csv")
    assert (tmp_path / "r.csv").read_text().startswith('"time_s"')
    assert_is_meant(read_recording(tmp_path / "r.csv"))


def test_latin_1_is_read_and_said(tmp_path):
    names = (*NAMES, "Öltemperatur °C")
    content = "\n".join(line + (",21.5" if number else "") for number, line in enumerate(text().splitlines()))
    content = content.replace(",".join(NAMES), ",".join(names)) + "\n"
    recording = read(tmp_path, content.encode("latin-1"))
    assert_is_meant(recording)
    assert recording["Öltemperatur °C"][0] == 21.5
    assert recording.notes == ["text is not UTF-8 and was read as Latin-1"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (text(names=("time", *NAMES[1:])), "its 'time' has no unit"),
        (text(names=("t", *NAMES[1:])), "its 't' has no unit"),
        (text(comma=True), "has 6 cells, the header line names 3\n  if the comma is the decimal sign"),
        (text(per_s=1e3), "samples are 1 s apart\n  if it is in milliseconds, name the column time_ms"),
        (text(names=("time_s [ms]", *NAMES[1:]), per_s=1e3), "is in s by its name and in 'ms' beside it"),
        (text(second="ms,Nm,rad/s", per_s=1e3), "is in s by its name and in 'ms' beside it"),
        (
            text(names=("time_s", "motor_speed_rad_s", "MOTOR_SPEED_rad_s")),
            "'motor_speed_rad_s' stands twice",
        ),
        (text(second="s,Nm,km/h"), "column 'motor_speed_rad_s': is in 'km/h', not in rad/s"),
        (text(names=(*NAMES[:2], "motor_speed_rad_s [V]")), "is in 'V', not in rad/s"),
        (text(names=(*NAMES[:2], "motor_speed_rad_s [1/s]")), "of radians or of revolutions"),
        ("time_s;motor_torque_ref_nm;motor_speed_rad_s\n0;1,234;2,345\n1;1,234;5\n", "may be 1.234 or 1234"),
        (";".join(NAMES) + "\n0,001;1.234,5;2\n", "'1.234,5' has a point and '0,001' a comma"),
        (";".join(NAMES) + "\n0.001;1,234.5;2\n", "a comma"),
        (";".join(NAMES) + "\n0.001;1;2\n0.002;1,5;2\n", "has a point and '1,5' a comma"),
        ('time_s,motor_torque_ref_nm,motor_speed_rad_s\n0.001,"1,234",2\n', "'1,234' is not a number"),
    ],
    ids=str,
)
def test_what_could_be_read_in_two_ways_is_refused(content, said, tmp_path):
    assert said in refused(tmp_path, content)


def test_a_point_after_a_thousand_commas_is_refused_with_its_line(tmp_path):
    rows = [f"{n / 1000:.3f};1,5;2,5".replace(".", ",") for n in range(20_000)]
    rows[15_000] = "15,0;1.500;2,5"
    content = "\n".join([";".join(NAMES), *rows]) + "\n"
    assert "line 15002, column 'motor_torque_ref_nm': '1.500' is not a number" in refused(tmp_path, content)


def test_lines_are_counted_below_a_line_of_units(tmp_path):
    content = ",".join(NAMES) + "\ns,Nm,rad/s\n0,1,2\n0.001,1,2\n0.001,1,2\n"
    assert "sample 3, line 5: 'time_s' does not increase" in refused(tmp_path, content)


def test_lines_are_counted_below_excels_separator(tmp_path):
    content = "sep=,\n" + ",".join(NAMES) + "\ns,Nm,rad/s\n0,1,2\n0.001,1,2\n0.001,1,2\n"
    assert "sample 3, line 6: 'time_s' does not increase" in refused(tmp_path, content)
    assert "line 2: the header line has no 'time_s'" in refused(tmp_path, "sep=;\na;b\n1;2\n")


def test_slow_samples_are_remarked_on(tmp_path):
    recording = read(tmp_path, text(per_s=100))
    assert recording.notes == ["samples are 0.1 s apart; a column in ms is to be named time_ms"]


numbers = st.floats(-1e6, 1e6).map(lambda value: round(value, 4))


@given(st.lists(numbers, min_size=3, max_size=20), st.sampled_from([",", ";", "\t"]), st.booleans())
def test_no_number_becomes_another_one(values, separator, comma):
    cells = [f"{value!r}" for value in values]
    rows = [f"{n / 1000!r}{separator}{cell}{separator}0" for n, cell in enumerate(cells)]
    content = separator.join(NAMES) + "\n" + "\n".join(rows) + "\n"
    content = content.replace(".", ",") if comma else content
    with tempfile.TemporaryDirectory() as directory:
        try:
            recording = read(Path(directory), content)
        except BadInputError:
            assert comma
            return
    np.testing.assert_array_equal(recording["motor_torque_ref_nm"], values)


def test_a_unit_of_the_same_quantity_is_converted_and_said(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text(second="s,kNm,rpm"))
    found = read_recording(path)
    np.testing.assert_allclose(found["motor_torque_ref_nm"][0], -1250.0)
    np.testing.assert_allclose(found["motor_speed_rad_s"][0], 1000.0 * 2 * np.pi / 60)
    assert "'motor_speed_rad_s' was converted from rpm to rad/s" in found.notes
    assert "'motor_torque_ref_nm' was converted from kNm to N m" in found.notes
