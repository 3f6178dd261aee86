"""Text of ControlDesk, LabVIEW, INCA, PUMA, built from descriptions: values right, assumptions reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import Recording, column_map, read_recording

COUNT = 120
SECONDS = np.arange(COUNT) * 1e-3
TORQUE = 40 * np.sin(SECONDS * 30)
RPM = 900 + 50 * np.cos(SECONDS * 30)
RAD_S = RPM * 2 * np.pi / 60
MAP = ("motor_torque_ref_nm=T_req", "motor_speed_rad_s=n_EM")


def read(tmp_path: Path, text: str, *options: str, name: str = "r.csv") -> Recording:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return read_recording(path, columns=column_map(options))


def rows(separator: str, *columns: list[str]) -> str:
    return "".join(separator.join(cells) + "\n" for cells in zip(*columns, strict=True))


def numbers(values: np.ndarray, comma: bool = False) -> list[str]:
    texts = [f"{value:.9e}" for value in values]
    return [text.replace(".", ",") for text in texts] if comma else texts


def assert_is_meant(found: Recording, time_s: np.ndarray = SECONDS) -> None:
    np.testing.assert_allclose(found.time_s, time_s, atol=1e-7)
    np.testing.assert_allclose(found["motor_torque_ref_nm"], TORQUE[: len(time_s)], atol=1e-6)
    np.testing.assert_allclose(found["motor_speed_rad_s"], RAD_S[: len(time_s)], rtol=1e-7)


def test_controldesk_csv(tmp_path: Path) -> None:
    head = (
        'fileVersion,2.0\nexperiment,"bench, left"\nstarted,2024-05-01 12:00:00\n\n'
        "path,,Model Root/T_req,Model Root/n_EM\nname,xAxis,T_req,n_EM\nunit,s,Nm,rpm\n"
        "type,float64,float64,float64\n"
    )
    label = ["trace_values", *[""] * (COUNT - 1)]
    body = rows(",", label, numbers(SECONDS), numbers(TORQUE), numbers(RPM))
    found = read(tmp_path, head + body, *MAP)
    assert_is_meant(found)
    assert "line 7 gives units" in found.notes
    assert "5 lines stand above the names, left out" in found.notes
    assert any("types or descriptions, left out" in note for note in found.notes)


@pytest.mark.parametrize("comma", [False, True])
def test_labview_lvm(tmp_path: Path, comma: bool) -> None:
    head = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
        f"Decimal_Separator\t{',' if comma else '.'}\nMulti_Headings\tNo\nX_Columns\tOne\n"
        "Time_Pref\tRelative\nOperator\tme\nDate\t2024/05/01\nTime\t12:00:01,123\n***End_of_Header***\t\n\t\n"
        "Channels\t2\t\t\nSamples\t120\t120\t\nX_Dimension\tTime\tTime\t\nX0\t0\t0\t\n"
        "Delta_X\t0.001\t0.001\t\n***End_of_Header***\t\t\t\nX_Value\tT_req\tn_EM\tComment\n"
    )
    body = rows("\t", numbers(SECONDS, comma), numbers(TORQUE, comma), numbers(RPM, comma))
    found = read(tmp_path, head + body, MAP[0], f"{MAP[1]}, unit=rpm", name="r.lvm")
    assert_is_meant(found)
    assert "'X_Value' was taken to be the time, in s as its tool writes it" in found.notes
    assert ("numbers have a decimal comma" in found.notes) == comma


def test_labview_lvm_without_a_column_of_time(tmp_path: Path) -> None:
    head = (
        "LabVIEW Measurement\t\nX_Columns\tNo\n***End_of_Header***\t\nDelta_X\t0.001\t0.001\n"
        "***End_of_Header***\t\t\nX_Value\tT_req\tn_EM\n"
    )
    found = read(
        tmp_path,
        head + rows("\t", [""] * COUNT, numbers(TORQUE), numbers(RPM)),
        MAP[0],
        f"{MAP[1]}, unit=rpm",
        name="r.lvm",
    )
    assert_is_meant(found)
    assert "time was counted: Delta_X in the preamble is 0.001 s" in found.notes


def test_inca_ascii(tmp_path: Path) -> None:
    head = (
        "ETASAsciiItemFile\trecord\tCrLf\tTab\nsampleCount\t120\ntime\tT_req\\ETKC:1\tn_EM\\ETKC:1\t\n"
        'f8\tf8\tf8\t\n"s"\t"Nm"\t"rpm"\t\n'
    )
    body = rows("\t", numbers(SECONDS), numbers(TORQUE), numbers(RPM), [""] * COUNT)
    found = read(tmp_path, (head + body).replace("\n", "\r\n"), *MAP, name="r.ascii")
    assert_is_meant(found)
    assert "'n_EM' was taken to be 'n_EM\\ETKC:1'" in found.notes
    assert "line 5 gives units" in found.notes


def test_puma_with_time_of_day_units_and_statistics_below(tmp_path: Path) -> None:
    stamps = [f"23:59:59.{950 + k:03d}" if k < 50 else f"00:00:00.{k - 50:03d}" for k in range(COUNT)]
    head = "Testbed: E7\nOperator: me\nTIME;T_req;n_EM\nhh:mm:ss;Nm;1/min\n"
    foot = "\nMIN;-40;850\nMAX;40;950\nEnd of file\n"
    found = read(tmp_path, head + rows(";", stamps, numbers(TORQUE), numbers(RPM)) + foot, *MAP)
    assert_is_meant(found)
    assert "the time of day passes midnight: stamps behind it are of the next day" in found.notes
    assert "3 lines at the end of the file: no samples, left out" in found.notes
    assert "'time_s' is a time of day: it was counted from the first" in found.notes


@pytest.mark.parametrize(
    "stamp",
    [
        lambda k: f"2024-02-28T23:59:59.{k + 900:03d}Z" if k < 100 else f"2024-02-29T00:00:00.{k - 100:03d}Z",
        lambda k: f"28.02.2024 23:59:59,{k + 900:03d}" if k < 100 else f"29.02.2024 00:00:00,{k - 100:03d}",
        lambda k: (
            f"02/28/2024 11:59:59.{k + 900:03d} PM" if k < 100 else f"02/29/2024 12:00:00.{k - 100:03d} AM"
        ),
        lambda k: f"12:00:00:{k:03d}",
    ],
)
def test_stamps_of_date_and_time(stamp, tmp_path: Path) -> None:
    text = "Zeit;T_req;n_EM\n" + rows(";", [stamp(k) for k in range(COUNT)], numbers(TORQUE), numbers(RPM))
    assert_is_meant(read(tmp_path, text, MAP[0], f"{MAP[1]}, unit=rpm"))


def test_a_time_of_day_that_goes_back_is_refused(tmp_path: Path) -> None:
    stamps = [f"12:00:00.{k % 60:03d}" for k in range(COUNT)]
    text = "time;T_req;n_EM\n" + rows(";", stamps, numbers(TORQUE), numbers(RPM))
    with pytest.raises(BadInputError, match="does not increase"):
        read(tmp_path, text, *MAP)


def test_cells_of_microsofts_library_are_missing(tmp_path: Path) -> None:
    speeds = numbers(RPM)
    speeds[50] = "-1.#IND"
    text = "t;T_req;n_EM\ns;Nm;rpm\n" + rows(";", numbers(SECONDS), numbers(TORQUE), speeds)
    found = read(tmp_path, text, *MAP)
    np.testing.assert_allclose(found["motor_speed_rad_s"], RAD_S, rtol=1e-3)
    assert any("1 missing cells of 'motor_speed_rad_s'" in note for note in found.notes)


def test_rates_with_blanks_between_come_to_the_inputs_rows(tmp_path: Path) -> None:
    torque = [cell if k % 2 == 0 else "" for k, cell in enumerate(numbers(TORQUE))]
    speed = [cell if k % 10 == 3 else "" for k, cell in enumerate(numbers(RPM))]
    text = "time_s,T_req,n_EM [rpm]\n" + rows(",", numbers(SECONDS), torque, speed)
    found = read(tmp_path, text, *MAP)
    assert found.time_s[0] == pytest.approx(0.004)
    np.testing.assert_allclose(np.diff(found.time_s), 0.002)
    np.testing.assert_allclose(
        found["motor_speed_rad_s"], np.interp(found.time_s, SECONDS[3::10], RAD_S[3::10])
    )
    assert "'motor_torque_ref_nm' stands in each 2nd row: the other rows were left out" in found.notes
    assert "'motor_speed_rad_s' stands in each 10th row: it was interpolated between" in found.notes


def test_blanks_in_no_order_are_refused_as_before(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    speed = [cell if keep else "" for cell, keep in zip(numbers(RPM), rng.random(COUNT) > 0.5, strict=True)]
    with pytest.raises(BadInputError, match="is NaN or infinite"):
        read(tmp_path, "time_s,T_req,n_EM\n" + rows(",", numbers(SECONDS), numbers(TORQUE), speed), *MAP)


@pytest.mark.parametrize(("quantum_s", "apart_s"), [(1e-3, 2.5e-3), (1e-2, 1e-3), (1e-2, 4e-3), (1.0, 0.02)])
def test_stamps_that_were_rounded_are_put_where_their_numbers_place_them(
    quantum_s: float, apart_s: float, tmp_path: Path
) -> None:
    count = 2000
    time_s = np.arange(count) * apart_s
    time_s[count // 2 :] += 3.0  # a gap
    rounded = np.floor(time_s / quantum_s + 0.3) * quantum_s
    torque = np.sin(time_s)
    text = "time_s,T_req,n_EM\n" + rows(
        ",", [f"{t:.3f}" for t in rounded], numbers(torque), numbers(torque + 5)
    )
    found = read(tmp_path, text, *MAP)
    error_s = found.time_s - time_s
    for half in (error_s[: count // 2], error_s[count // 2 :]):
        assert np.ptp(half) < 0.05 * quantum_s  # but for one constant
    assert any("stamps are rounded to" in note for note in found.notes)


def test_stamps_on_a_grid_that_samples_keep_are_left_alone(tmp_path: Path) -> None:
    kept = np.delete(np.arange(COUNT), [20, 21, 60])  # lost samples of a clock of 1 kHz
    text = "time_s,T_req,n_EM\n" + rows(
        ",", [f"{t:.3f}" for t in SECONDS[kept]], numbers(TORQUE[kept]), numbers(RPM[kept])
    )
    found = read(tmp_path, text, *MAP)
    np.testing.assert_allclose(found.time_s, SECONDS[kept], atol=1e-12)


def test_stamps_that_repeat_unevenly_are_refused_with_the_option(tmp_path: Path) -> None:
    stamps = np.sort(np.random.default_rng(1).integers(0, 20, COUNT)) * 0.01
    text = "time_s,T_req,n_EM\n" + rows(",", [f"{t:.2f}" for t in stamps], numbers(TORQUE), numbers(RPM))
    with pytest.raises(BadInputError, match="every_s="):
        read(tmp_path, text, *MAP)


@pytest.mark.parametrize(("unit", "per_s", "bits"), [("ms", 1e3, 16), ("us", 1e6, 32)])
def test_time_that_counts_and_begins_again_goes_on(
    unit: str, per_s: float, bits: int, tmp_path: Path
) -> None:
    counter = np.mod(2**bits - 30 * per_s * 1e-3 + SECONDS * per_s, 2**bits)
    text = f"time_{unit},T_req,n_EM\n" + rows(
        ",", [f"{c:.0f}" for c in counter], numbers(TORQUE), numbers(RPM)
    )
    found = read(tmp_path, text, *MAP)
    np.testing.assert_allclose(np.diff(found.time_s), 1e-3, atol=1e-9)
    assert any(f"counts in {bits} bits" in note for note in found.notes)


def test_samples_below_a_line_of_text_are_refused_with_its_line(tmp_path: Path) -> None:
    body = rows(",", numbers(SECONDS), numbers(TORQUE), numbers(RPM))
    with pytest.raises(BadInputError, match=r"(?s)line 122, column.*samples go on below"):
        read(tmp_path, "time_s,T_req,n_EM\n" + body + "Second measurement\n" + body, *MAP)


def test_a_line_of_units_with_one_that_is_none_is_refused(tmp_path: Path) -> None:
    body = rows(",", numbers(SECONDS), numbers(TORQUE), numbers(RPM))
    with pytest.raises(BadInputError, match="line 2, column.*'Umdr.' stands in a line of units"):
        read(tmp_path, "time_s,T_req,n_EM\ns,Nm,Umdr.\n" + body, *MAP)


def test_a_line_that_may_be_units_in_another_language_needs_units_in_the_map(tmp_path: Path) -> None:
    body = rows(",", numbers(SECONDS), numbers(TORQUE), numbers(RPM))
    text = "t,T_req,n_EM\nSek.,Newtonm,Umdr.\n" + body
    with pytest.raises(BadInputError, match="line 2: 'Sek.' stands below a name"):
        read(tmp_path, text, "time_s=t", *MAP)
    given = ("time_s=t, unit=s", "motor_torque_ref_nm=T_req, unit=N m", "motor_speed_rad_s=n_EM, unit=rpm")
    assert_is_meant(read(tmp_path, text, *given))


def test_columns_of_a_file_without_a_map_are_listed_with_the_option(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="--columns") as caught:
        read(tmp_path, "zeitpunkt,M_soll,n_EM\n0,1,2\n")
    assert "it has: zeitpunkt, M_soll, n_EM" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "content", "reported"),
    [
        ("r.xlsx", b"PK\x03\x04", "is a spreadsheet"),
        ("r.csv", b"PK\x03\x04....", "is no .csv file but a spreadsheet"),
        ("r.blf", b"LOGG", "hil replay"),
        ("r.dat", b"MDF     3.30", "asammdf converts it"),
        ("r.csv", b"\x89HDF\r\n\x1a\n", "name it .h5"),
        ("r.pkl", b"\x80\x04", "to_parquet"),
    ],
)
def test_what_is_not_read_is_named_with_what_reads_it(
    name: str, content: bytes, reported: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadInputError) as caught:
        read_recording(tmp_path / name)
    assert reported in str(caught.value)
