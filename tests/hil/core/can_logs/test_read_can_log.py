"""Logs as others write them: every frame, its stamp and its kind; what is broken is stated."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest
from asammdf import MDF, Signal, Source
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST
from hil.core.can_logs import READ, read_can_log
from hil.core.errors import BadInputError

BEGAN_S = 1_772_612_100.25
WRITERS = {
    ".asc": can.ASCWriter,
    ".blf": can.BLFWriter,
    ".log": can.CanutilsLogWriter,
    ".trc": can.TRCWriter,
}
CHANNEL = {".asc": "1", ".blf": "1", ".log": "can0", ".trc": "1"}
FIRST_S = {".asc": 0.0, ".trc": 0.0}  # these count from their first frame, whose moment is in their head


def message(place: int, **changes) -> can.Message:
    data = bytes([place, 0xFF, 0x80])
    given_: dict[str, Any] = {"arbitration_id": 0x123, "is_extended_id": False, "data": data} | changes
    channel = given_.pop("channel", 0)
    return can.Message(timestamp=BEGAN_S + 0.01 * place, channel=channel, **given_)


def written(path: Path, *messages: can.Message) -> Path:
    writer = WRITERS[path.suffix]
    with writer(path) as log:
        for one in messages:
            one.channel = "can0" if path.suffix == ".log" else one.channel
            log.on_message_received(one)
    return path


@pytest.mark.parametrize("ending", WRITERS)
def test_every_frame_is_there_with_its_stamp(ending: str, tmp_path: Path) -> None:
    messages = [
        message(0),
        message(1, is_rx=False),
        message(2, arbitration_id=0x1ABCDEF, is_extended_id=True),
    ]
    log = read_can_log(written(tmp_path / f"a{ending}", *messages))
    assert list(log.channels) == [CHANNEL[ending]]
    block = log.channels[CHANNEL[ending]]
    assert block["id"].tolist() == [0x123, 0x123, 0x1ABCDEF]
    assert block["flags"].tolist() == [0, SENT_BY_HOST, EXTENDED]
    assert block["length"].tolist() == [3, 3, 3]
    assert block["data"].tolist() == [0x80FF00, 0x80FF01, 0x80FF02]
    np.testing.assert_allclose(np.diff(block["time_s"]), 0.01, atol=2e-6)
    assert log.began_ns is not None
    if ending not in FIRST_S:
        np.testing.assert_allclose(log.began_ns * 1e-9 + block["time_s"][0], BEGAN_S, atol=1e-5)


@pytest.mark.parametrize("ending", [".asc", ".blf", ".log"])
def test_what_a_recording_has_no_place_for_is_counted(ending: str, tmp_path: Path) -> None:
    messages = [
        message(0),
        message(1, is_remote_frame=True, data=None, dlc=2),
        message(2, is_fd=True, data=bytes(12)),
        message(3, is_fd=True, data=bytes(8)),
    ]
    log = read_can_log(written(tmp_path / f"a{ending}", *messages))
    assert log.left_out == {"remote frames": 1, "CAN FD frames of more than 8 bytes": 1}
    assert log.count == 2


def test_error_frames_are_frames_of_their_own_kind(tmp_path: Path) -> None:
    path = written(tmp_path / "a.asc", message(0), message(1, is_error_frame=True, data=None))
    (block,) = read_can_log(path).channels.values()
    assert block["flags"].tolist()[1] & ERROR_FRAME


def test_a_last_line_that_is_cut_off_is_no_frame(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text("(100.000000) can0 123#0102030405060708\n(100.010000) can0 123#01020304050607")
    log = read_can_log(path)
    assert log.count == 1
    assert log.remarks == ["its last line is cut off, and was left out"]
    assert log.began_ns is None


def test_a_line_that_has_fewer_bytes_than_it_says_is_no_frame(tmp_path: Path) -> None:
    path = tmp_path / "a.asc"
    path.write_text("base hex timestamps absolute\n 0.1 1 123 Rx d 2 01 02\n 0.2 1 123 Rx d 2 01")
    log = read_can_log(path)
    assert (log.count, log.left_out) == (1, {"frames with fewer bytes than they say": 1})


def test_a_log_that_breaks_in_the_middle_is_read_up_to_there(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(f"(1.0) can0 123#01\n(1.1) can0 123#02\n{'x' * 5000}\n(1.2) can0 123#03")
    log = read_can_log(path)
    assert log.count == 2
    assert "is broken after 2 frames; what came before was read" in log.remarks


def test_an_odd_line_is_counted_and_a_raw_length_code_is_none(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(
        "(1.0) can0 123#01\nwhat is this\n(1.1) can0 123#1122334455667788_E\n(1.2) can0 123#R\n\nand this\n"
    )
    log = read_can_log(path)
    assert log.channels["can0"]["length"].tolist() == [1, 8]
    assert log.left_out == {"remote frames": 1}
    assert log.remarks == ["2 lines are no frame and left out, the first is line 2"]


RESTART = "(1.0) can0 123#01\n(1.3) can0 123#02\n(1.01) can0 123#03\n(1.2) can0 123#04\n"


def test_stamps_that_go_back_are_refused_until_somebody_says_what_they_mean(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(RESTART)
    with pytest.raises(BadInputError, match=r"go back by up to 0.29 s, first at frame 3") as caught:
        read_can_log(path)
    assert "--stamps append" in caught.value.fix
    block = read_can_log(path, "append").channels["can0"]
    assert block["data"].tolist() == [1, 2, 3, 4]
    np.testing.assert_allclose(block["time_s"], [1.0, 1.3, 1.3, 1.49])
    assert read_can_log(path, "sort").channels["can0"]["data"].tolist() == [1, 3, 4, 2]


def test_a_log_may_be_late_with_a_frame(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text("(1.00) can0 123#01\n(1.05) can1 123#02\n(1.01) can0 123#03\n")
    log = read_can_log(path)
    assert log.count == 3
    assert log.remarks == []


def test_what_trigger_blocks_were_taken_for_is_said(tmp_path: Path) -> None:
    path = tmp_path / "a.asc"
    head = "date Mon Mar 7 01:21:51.000 pm 2005\nbase hex  timestamps absolute\ninternal events logged\n"
    begin = "Begin Triggerblock Mon Mar 7 01:2{n}:51.000 pm 2005\n"
    one = begin + "   {n}.1 1  100  Rx   d 1 0{n}\nEnd TriggerBlock\n"
    path.write_text(head + "".join(one.format(n=n) for n in (1, 2)))
    log = read_can_log(path)
    assert log.count == 2
    (block,) = log.channels.values()
    assert np.diff(block["time_s"]) == pytest.approx([61.0])
    assert log.remarks[0] == "has 2 trigger blocks: stamps count from each block's own date"


def test_a_blf_that_was_cut_says_so(tmp_path: Path) -> None:
    path = written(tmp_path / "a.blf", *(message(place % 256) for place in range(30_000)))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    log = read_can_log(path)
    assert 0 < log.count < 30_000
    assert log.remarks[-1] == f"is cut off: {len(whole) // 2} of {len(whole)} bytes are there"


def test_stamps_that_count_from_the_line_before_are_summed(tmp_path: Path) -> None:
    path = tmp_path / "a.asc"
    path.write_text(
        "date Wed Mar 4 09:15:00.250 2026\nbase hex  timestamps relative\ninternal events logged\n"
        " 0.100000 1  123  Rx   d 1 01\n 0.020000 Start of something else\n 0.030000 1  123  Rx   d 1 02\n"
    )
    (block,) = read_can_log(path).channels.values()
    np.testing.assert_allclose(np.diff(block["time_s"]), [0.05], atol=1e-6)


def test_a_day_in_a_language_that_nobody_knows_costs_the_day_only(tmp_path: Path) -> None:
    path = tmp_path / "a.asc"
    path.write_text("date ma helmi 4 09:15:00 2026\nbase hex timestamps absolute\n 0.1 1 123 Rx d 1 01\n")
    log = read_can_log(path)
    assert (log.count, log.began_ns) == (1, None)
    assert "cannot be read" in log.remarks[0]


@pytest.mark.parametrize("ending", READ)
def test_what_is_something_else_is_refused_by_name(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{ending}"
    path.write_text("hello there, this is\n no log, but [1, 2 words\n")
    with pytest.raises(BadInputError) as error:
        read_can_log(path)
    assert error.value.where == str(path)


def bus_log(path: Path, names: dict[str, Any], times_s: np.ndarray) -> Path:
    kind = [(f"CAN_DataFrame.{name}", column.dtype, column.shape[1:]) for name, column in names.items()]
    rows = np.zeros(len(times_s), kind)
    for name, column in names.items():
        rows[f"CAN_DataFrame.{name}"] = column
    source = Source("CAN", "CAN", "", Source.SOURCE_BUS, Source.BUS_TYPE_CAN)
    with MDF(version="4.10") as mdf:
        mdf.header.start_time = datetime.datetime(2026, 3, 4, 9, 15, tzinfo=datetime.UTC)
        mdf.append(Signal(samples=rows, timestamps=times_s, name="CAN_DataFrame", source=source))
        mdf.save(path, overwrite=True)
    return path


def test_mdf_of_a_logger_with_room_for_64_bytes_and_two_buses_in_a_group(tmp_path: Path) -> None:
    data = np.arange(3 * 64, dtype=np.uint8).reshape(3, 64)
    names = {
        "BusChannel": np.array([1, 2, 1], np.uint8),
        "ID": np.array([0x123, 0x9ABCDEF0, 0x124], np.uint32),
        "DataLength": np.array([2, 8, 12], np.uint8),
        "DataBytes": data,
    }
    log = read_can_log(bus_log(tmp_path / "a.mf4", names, np.array([0.5, 0.6, 0.7])))
    assert {name: block["id"].tolist() for name, block in log.channels.items()} == {
        "1": [0x123],
        "2": [0x1ABCDEF0],
    }
    assert log.channels["1"]["data"].tolist() == [0x0100]  # what is beyond its length is not its data
    assert log.channels["2"]["flags"].tolist() == [EXTENDED]
    assert log.left_out == {"CAN FD frames of more than 8 bytes": 1}
    assert log.began_ns == 1_772_615_700 * 10**9


def test_an_mdf_of_channels_is_sent_to_who_reads_it(tmp_path: Path) -> None:
    with MDF(version="4.10") as mdf:
        mdf.append(Signal(samples=np.zeros(3), timestamps=np.arange(3.0), name="x"))
        mdf.save(tmp_path / "a.mf4")
    with pytest.raises(BadInputError, match="holds channels and no CAN frames"):
        read_can_log(tmp_path / "a.mf4")


@given(
    st.lists(
        st.tuples(st.integers(0, 0x7FF), st.binary(max_size=8), st.floats(0, 1e3), st.sampled_from("ab")),
        min_size=1,
        max_size=30,
    )
)
def test_candump_text_gives_what_was_on_the_bus(tmp_path_factory, frames) -> None:
    path = tmp_path_factory.mktemp("log") / "a.log"
    path.write_text("".join(f"({t:.6f}) {bus} {i:03X}#{d.hex()}\n" for i, d, t, bus in frames))
    log = read_can_log(path, "sort")
    for name, block in log.channels.items():
        its = sorted((round(t, 6), i, d) for i, d, t, bus in frames if bus == name)
        read = [
            (
                round(float(f["time_s"]), 6),
                int(f["id"]),
                int(f["data"]).to_bytes(8, "little")[: int(f["length"])],
            )
            for f in block
        ]
        assert sorted(read) == its
        assert np.all(np.diff(block["time_s"]) >= 0)


@given(st.sampled_from(sorted(set(READ) - {".mcap", ".mf4"})), st.binary(max_size=300))
def test_bytes_of_any_kind_give_frames_or_a_message(tmp_path_factory, ending: str, content: bytes) -> None:
    path = tmp_path_factory.mktemp("log") / f"a{ending}"
    path.write_bytes(content)
    try:
        assert read_can_log(path).channels
    except BadInputError as error:
        assert error.where == str(path)


def test_an_object_of_a_blf_without_length_is_not_read_for_ever(tmp_path: Path) -> None:
    path = tmp_path / "stands.blf"
    with can.BLFWriter(path, compression_level=0) as writer:
        writer.on_message_received(can.Message(timestamp=1.0, arbitration_id=0x111, data=b"12345678"))
    content = bytearray(path.read_bytes())
    at = content.rindex(b"LOBJ") + 8
    content[at : at + 4] = bytes(4)
    path.write_bytes(content)
    with pytest.raises(BadInputError, match="an object of 0 bytes"):
        read_can_log(path)


def test_a_log_without_line_ends_is_not_held_whole(tmp_path):
    path = tmp_path / "long.log"
    path.write_text("(0.000000) can0 123#00\n")
    with path.open("ab") as file:
        file.truncate(1 << 36)  # holes: no room on the disk
    log = read_can_log(path)
    assert log.count == 1
    assert any("broken after 1 frames" in remark for remark in log.remarks)
