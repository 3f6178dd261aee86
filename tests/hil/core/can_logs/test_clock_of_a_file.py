"""What the stamps of a log count from is tested against the file; what contradicts itself is refused."""

from __future__ import annotations

import datetime
from pathlib import Path

import numpy as np
import pytest

from hil.core.can_logs import CanLog, Stamps, read_can_log
from hil.core.errors import BadInputError

HEAD = "date Mon Mar 7 01:21:51.000 pm 2005\nbase hex  timestamps absolute\ninternal events logged\n"
BEGAN_NS = round(datetime.datetime(2005, 3, 7, 13, 21, 51).timestamp()) * 10**9


def block(second: str, *stamps: float) -> str:
    lines = "".join(f"   {stamp:.6f} 1  100  Rx   d 1 01\n" for stamp in stamps)
    return f"Begin Triggerblock Mon Mar 7 01:{second}.000 pm 2005\n{lines}End TriggerBlock\n"


def read(tmp_path: Path, text: str, stamps: Stamps = "", name: str = "a.asc") -> CanLog:
    (tmp_path / name).write_text(text)
    return read_can_log(tmp_path / name, stamps)


def since_head_s(log: CanLog) -> list[float]:
    (frames,) = log.channels.values()
    assert log.began_ns is not None
    return (frames["time_s"] + (log.began_ns - BEGAN_NS) * 1e-9).tolist()


FROM_LOG, FROM_BLOCK = "count from the log's begin", "count from each block's own date"
TWO = [0.1, 0.2, 10.1, 10.2]


@pytest.mark.parametrize(
    ("blocks", "expected", "reported"),
    [
        (block("21:51", 0.1, 0.2) + block("22:01", 10.1, 10.2), TWO, FROM_LOG),
        (block("21:51", 0.1, 0.2) + block("22:01", 0.1, 0.2), TWO, FROM_BLOCK),
        (
            block("21:51", 0.1, 5.0) + block("22:51", 0.1) + block("23:51", 1.0),
            [0.1, 5, 60.1, 121],
            FROM_BLOCK,
        ),
        (block("22:51", 60.5, 61.0), [60.5, 61.0], FROM_LOG),
        (block("22:51", 0.5, 1.0), [60.5, 61.0], "stamps count from the block's date"),
        (block("21:51", 0.5, 1.0), [0.5, 1.0], ""),
    ],
)
def test_stamps_of_trigger_blocks_lie_where_their_dates_put_them(
    blocks: str, expected: list[float], reported: str, tmp_path: Path
) -> None:
    log = read(tmp_path, HEAD + blocks)
    assert since_head_s(log) == pytest.approx(expected, abs=1e-5)
    assert any(reported in remark for remark in log.remarks) if reported else log.remarks == []


def test_trigger_blocks_that_fit_both_ways_or_neither_are_refused_with_the_option(tmp_path: Path) -> None:
    both = HEAD + block("21:51", 0.1) + block("22:11", 40.0)
    with pytest.raises(BadInputError, match="alike") as caught:
        read(tmp_path, both)
    assert "--stamps log" in caught.value.fix
    assert since_head_s(read(tmp_path, both, "log")) == pytest.approx([0.1, 40.0])
    assert since_head_s(read(tmp_path, both, "block")) == pytest.approx([0.1, 60.0])
    neither = HEAD + block("21:51", 0.1, 30.0) + block("22:01", 0.1, 0.2)
    with pytest.raises(BadInputError, match="contradict each other"):
        read(tmp_path, neither)


def test_times_of_day_in_an_asc_of_busmaster_are_no_seconds_since_its_date(tmp_path: Path) -> None:
    """As in can-utils' issue 348: a head of 11:21:13 am, and stamps from 40874.8 s on."""
    text = (
        "date Mon Dec 6 11:21:13 am 2021\nbase hex  no internal events logged\n// version 7.1.0\n"
        "40874.808200 1 122 Rx d 8 E3 0C 00 FE 07 00 00 28\n"
        "40874.809100 1 3E5 Rx d 8 E6 2A 00 00 00 00 00 00\n"
    )
    log = read(tmp_path, text)
    (frames,) = log.channels.values()
    assert log.began_ns is not None
    first_s = log.began_ns * 1e-9 + frames["time_s"][0]
    assert first_s == pytest.approx(datetime.datetime(2021, 12, 6, 11, 21, 14, 808200).timestamp(), abs=1e-3)
    assert any("times of day" in remark for remark in log.remarks)


def test_a_time_of_day_passes_midnight(tmp_path: Path) -> None:
    text = (
        "date Mon Dec 6 11:59:59 pm 2021\nbase hex  timestamps absolute\n// version 7.1.0\n"
        "86399.900000 1 122 Rx d 1 E3\n0.100000 1 122 Rx d 1 E3\n"
    )
    (frames,) = read(tmp_path, text).channels.values()
    assert np.diff(frames["time_s"]) == pytest.approx([0.2], abs=1e-6)


BUSMASTER = """***BUSMASTER Ver 2.4.0***
***PROTOCOL CAN***
***[START LOGGING SESSION]***
***START DATE AND TIME 8:8:2014 {clock}***
***HEX***
***{mode} MODE***
***<Time><Tx/Rx><Channel><CAN ID><Type><DLC><DataBytes>***
{frames}***END DATE AND TIME 8:8:2014 12:0:0:0***
***[STOP LOGGING SESSION]***
"""


@pytest.mark.parametrize(
    ("mode", "clock", "stamps"),
    [
        ("SYSTEM", "11:49:7:965", ["11:49:12:9420", "11:49:12:9440", "11:49:13:0440"]),
        ("SYSTEM", "23:59:59:0", ["23:59:59:9990", "0:0:0:0010", "0:0:0:1010"]),
        ("ABSOLUTE", "11:49:7:965", ["0:00:01:0000", "0:00:01:0020", "0:00:01:1020"]),
        ("RELATIVE", "11:49:7:965", ["0:00:01:0000", "0:00:00:0020", "0:00:00:1000"]),
    ],
)
def test_busmasters_own_log(mode: str, clock: str, stamps: list[str], tmp_path: Path) -> None:
    kinds = ["0x023 s 1 40", "0x16A954A6 x 2 00 01", "0x460 sr 8"]
    frames = "".join(f"{stamp} Rx 1 {kind}\n" for stamp, kind in zip(stamps, kinds, strict=True))
    log = read(tmp_path, BUSMASTER.format(mode=mode, clock=clock, frames=frames), name="a.log")
    (found,) = log.channels.values()
    assert found["id"].tolist() == [0x23, 0x16A954A6]
    assert found["flags"].tolist() == [0, 1]
    assert np.diff(found["time_s"]) == pytest.approx([0.002], abs=1e-6)
    assert log.left_out == {"remote frames": 1}
    assert any("BusMaster's" in remark for remark in log.remarks)


def test_a_log_that_skips_says_so_and_one_whose_clock_was_set_is_refused(tmp_path: Path) -> None:
    pause = "(1700000000.0) can0 123#01\n(1700000300.0) can0 123#02\n"
    reported = read(tmp_path, pause, name="a.log").remarks
    assert reported == ["its stamps skip 300 s at frame 2: no frame lies between"]
    stamps = ("12.0", "12.1", "1700000300.0", "1700000300.1")
    clock_set = "".join(f"({stamp}) can0 123#01\n" for stamp in stamps)
    with pytest.raises(BadInputError, match="a clock is set") as caught:
        read(tmp_path, clock_set, name="a.log")
    assert "--stamps append" in caught.value.fix
    (frames,) = read(tmp_path, clock_set, "append", name="a.log").channels.values()
    assert np.diff(frames["time_s"]) == pytest.approx([0.1, 0.0, 0.1], abs=1e-5)
