"""DBC files that cannot be used: each is refused with file, message and signal."""

import math
import os
import re
from pathlib import Path

import pytest
from cantools.database.can import Signal as DbcSignal
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.core.can.dbc import Needed, _bits, read_dbc
from hil.core.errors import BadInputError

BENCHES = Path(__file__).parents[4] / "benches"
TEXT = (BENCHES / "rmcu.dbc").read_text()
NEEDED = {
    "RMCU_Request": Needed(("Counter", "Crc"), whole=("Counter", "Crc"), checksum="Crc"),
    "RMCU_Status": Needed(("MotorSpeed", "MotorTorqueRef", "MotorTorque")),
    "RMCU_Control": Needed(("State",), whole=("State",), texts={"State": ("off",)}),
}


def refused(text, tmp_path):
    path = tmp_path / "some.dbc"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(BadInputError) as caught:
        read_dbc(path, NEEDED)
    error = caught.value
    assert error.where == str(path)
    assert error.fix
    assert all(c.isprintable() for c in error.what)
    return error.what


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("SG_ MotorSpeed :", "SG_ Other :", "message 'RMCU_Status' has no signal 'MotorSpeed'"),
        ("BO_ 256 RMCU_Request", "BO_ 256 Request", "has no message 'RMCU_Request'"),
        ("22@1- (0.001,0)", "22@1- (0,0)", "'RMCU_Status', signal 'MotorSpeed' has the factor 0"),
        ("MotorTorque : 42|14", "MotorTorque : 42|30", "'MotorTorque' reaches beyond the message's 8 bytes"),
        ("MotorTorqueRef : 26|", "MotorTorqueRef : 20|", "'MotorSpeed' and 'MotorTorqueRef' overlap"),
        ("BO_ 272", "BO_ 2147483920", "'RMCU_Status': identifier 0x110 is extended"),
        ("BO_ 272", "BO_ 3000", "more than 11 bits"),
        ("RMCU_Status: 8", "RMCU_Status: 64", "'RMCU_Status' has 64 bytes"),
        ("VAL_ 273 State", "VAL_ 273 Counter", "signal 'State' has no value named 'off'"),
        ("State : 40|4@1+ (1,0)", "State : 40|4@1+ (2,0)", "signal 'State' counts"),
        ("Crc : 56|8@1+", "Crc : 48|8@1+", "'Crc' is not byte 7"),
    ],
)
def test_what_cannot_be_used_is_told_with_message_and_signal(old, new, said, tmp_path):
    assert old in TEXT
    assert said in refused(TEXT.replace(old, new), tmp_path)


def test_all_missing_messages_are_named_at_once_with_the_table_that_maps_names(tmp_path):
    path = tmp_path / "some.dbc"
    path.write_text(TEXT.replace(" RMCU_Request", " Request").replace(" RMCU_Control", " Control"))
    with pytest.raises(BadInputError) as caught:
        read_dbc(path, NEEDED)
    assert caught.value.what == "has no messages 'RMCU_Request', 'RMCU_Control'"
    assert "[rmcu.messages]" in caught.value.fix


def test_a_multiplexed_signal_is_refused(tmp_path):
    text = TEXT.replace("SG_ MotorSpeed :", "SG_ MotorSpeed m0 :")
    text = text.replace("SG_ MotorTorque :", "SG_ MotorTorque M :")
    assert "'MotorSpeed' is multiplexed" in refused(text, tmp_path)


def test_a_float_of_a_width_that_ieee_does_not_have_is_refused(tmp_path):
    text = TEXT + "SIG_VALTYPE_ 272 MotorTorque : 1;\n"
    assert "'MotorTorque' is a float of 14 bits" in refused(text, tmp_path)


def test_colliding_identifiers_are_refused(tmp_path):
    text = TEXT.replace("BO_ 273", "BO_ 272").replace(" 273 ", " 272 ")
    assert "'RMCU_Status' and 'RMCU_Control' have the same identifier 0x110" in refused(text, tmp_path)


def test_what_is_wrong_with_a_message_that_nobody_needs_does_not_matter(tmp_path):
    path = tmp_path / "some.dbc"
    path.write_text(TEXT.replace("VehicleSpeed : 0|32@1- (0.00001,0)", "VehicleSpeed : 40|32@1- (0,0)"))
    assert set(read_dbc(path, NEEDED).layouts) == set(NEEDED)


@pytest.mark.parametrize(
    "content",
    [b"", b"hello there", b"\0\1\2" * 100, (BENCHES / "rcs_dyno.eds").read_bytes(), b"BO_ \x1b[31m red"],
)
def test_another_kind_of_file_is_refused_without_its_control_characters(content, tmp_path):
    assert "not a DBC file" in refused(content, tmp_path)


@pytest.mark.parametrize("kind", ["missing", "directory", "device"])
def test_what_is_no_file_is_refused(kind, tmp_path):
    path = {"missing": tmp_path / "none.dbc", "directory": tmp_path, "device": Path(os.devnull)}[kind]
    with pytest.raises(BadInputError, match=re.escape(str(path))):
        read_dbc(path, NEEDED)


@settings(max_examples=50)
@given(data=st.data())
def test_a_damaged_dbc_is_read_or_refused_but_never_more(data):
    content = bytearray(TEXT.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    path = Path(os.environ.get("TMPDIR", "/tmp")) / f"damaged-{os.getpid()}.dbc"
    path.write_bytes(bytes(content))
    try:
        read_dbc(path, NEEDED)
    except BadInputError:
        pass
    finally:
        path.unlink()


@pytest.mark.parametrize(("start", "length"), [(7, 16), (3, 12), (43, 20), (42, 20), (0, 2), (15, 1)])
def test_a_big_endian_signals_bits_lie_as_motorola_counts_them(start, length):
    signal = DbcSignal("S", start, length, byte_order="big_endian")
    walked = [start]  # down to the byte's lowest bit, then on with the next byte's highest
    while len(walked) < length:
        walked.append(walked[-1] - 1 if walked[-1] % 8 else walked[-1] + 15)
    assert _bits(signal) == walked
    assert _bits(DbcSignal("S", start, length, byte_order="little_endian")) == list(
        range(start, start + length)
    )


def test_values_in_another_unit_are_converted_and_said(tmp_path):
    path = tmp_path / "some.dbc"
    text = TEXT.replace('[-2097|2097] "rad/s"', '[-2097|2097] "rpm"').replace(
        '[-327|327] "Nm"', '[-327|327] "kNm"'
    )
    path.write_text(text)
    units = {"MotorSpeed": "rad/s", "MotorTorqueRef": "N m", "MotorTorque": "N m"}
    needed = {"RMCU_Status": Needed(tuple(units), units=units)}
    own, other = (read_dbc(file, needed) for file in (BENCHES / "rmcu.dbc", path))
    ours, theirs = (read.layouts["RMCU_Status"].signals for read in (own, other))
    assert theirs["MotorSpeed"].scale == pytest.approx(ours["MotorSpeed"].scale * 2 * math.pi / 60)
    assert theirs["MotorTorqueRef"].scale == pytest.approx(1000 * ours["MotorTorqueRef"].scale)
    assert theirs["MotorTorque"] == ours["MotorTorque"]
    assert [remark.partition("message ")[2] for remark in other.remarks] == [
        "'RMCU_Status', signal 'MotorSpeed' was converted from rpm to rad/s",
        "'RMCU_Status', signal 'MotorTorqueRef' was converted from kNm to N m",
    ]
    assert own.remarks == ()
    path.write_text(TEXT.replace('[-2097|2097] "rad/s"', '[-2097|2097] ""'))
    assert "says no unit and is taken in rad/s" in read_dbc(path, needed).remarks[0]
    path.write_text(TEXT.replace('[-2097|2097] "rad/s"', '[-2097|2097] "km/h"'))
    with pytest.raises(BadInputError, match="signal 'MotorSpeed' is in 'km/h', not in rad/s"):
        read_dbc(path, needed)
