"""J1939: messages of any source address are decoded for each that sends them; others by whole identifier."""

from __future__ import annotations

from pathlib import Path

import cantools.j1939
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.dbc_messages import group_of, read_messages_of
from hil.core.can_logs import read_can_log
from hil.core.recording import read_as_written
from hil.engine.replay import ReplayRequest, replay

ENGINE, ENGINE_OF_0 = 0x0CF00400, 0x18FEF100
DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ {any_engine} EEC1: 8 A
 SG_ EngSpeed : 24|16@1+ (0.125,0) [0|8031.875] "rpm" A
BO_ {one_speed} CCVS: 8 A
 SG_ Speed : 8|16@1+ (0.00390625,0) [0|250] "km/h" A
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_DEF_DEF_ "VFrameFormat" "{kind}";
"""


@given(st.integers(0, (1 << 29) - 1))
def test_the_group_is_that_of_cantools(identifier: int) -> None:
    parts = cantools.j1939.frame_id_unpack(identifier)
    specific = parts.pdu_specific if parts.pdu_format >= 240 else 0
    wanted = cantools.j1939.pgn_pack(parts.reserved, parts.data_page, parts.pdu_format, specific)
    assert group_of(identifier) == wanted


def replayed(tmp_path: Path, *identifiers: int, kind: str = "J1939PG"):
    extended = 1 << 31
    named = {"any_engine": (0x0CF004FE | extended), "one_speed": (ENGINE_OF_0 | extended)}
    (tmp_path / "a.dbc").write_text(DBC.format(kind=kind, **named))
    lines = [
        f"({1.7e9 + 0.01 * k:.6f}) can0 {identifier:08X}#FFFFFF{1000 * 8 + 8 * k & 255:02X}1FFFFFFF\n"
        for k in range(40)
        for identifier in identifiers
    ]
    (tmp_path / "a.log").write_text("".join(lines))
    request = ReplayRequest([tmp_path / "a.log"], dbcs={"": tmp_path / "a.dbc"})
    return replay(request, tmp_path / "r.mcap")


def test_a_message_of_any_address_is_decoded_for_the_one_that_sends_it(tmp_path: Path) -> None:
    found = replayed(tmp_path, ENGINE)
    assert found.counts.as_json()["decoded"] == found.counts.all == 40
    assert found.channels == ("time_s", "EngSpeed")
    assert "message 'EEC1' is of any source address in the DBC: sent by 0x00" in found.remarks
    assert read_as_written(tmp_path / "r.mcap")["EngSpeed"][0] == pytest.approx(0x1F40 * 0.125)


def test_two_addresses_are_two_channels_and_never_one(tmp_path: Path) -> None:
    found = replayed(tmp_path, ENGINE, ENGINE | 1, ENGINE | 0xFE)
    assert found.counts.decoded == found.counts.all == 120
    assert set(found.channels) == {"time_s", *(f"EEC1_{address}_EngSpeed" for address in ("00", "01", "FE"))}


def test_another_address_than_the_dbcs_is_counted_with_the_reason(tmp_path: Path) -> None:
    found = replayed(tmp_path, ENGINE, ENGINE_OF_0 | 0x21)
    counts = found.counts.as_json()
    assert (counts["decoded"], counts["of_no_message"], counts["all"]) == (40, 40, 80)
    assert any(
        "group of message 'CCVS', which the DBC has for address 0x00 alone" in r for r in found.remarks
    )


def test_a_dbc_that_is_not_of_j1939_is_matched_by_whole_identifiers(tmp_path: Path) -> None:
    found = replayed(tmp_path, ENGINE, ENGINE_OF_0, kind="ExtendedCAN")
    assert found.counts.as_json()["of_no_message"] == 40
    layouts, _ = read_messages_of(tmp_path / "a.dbc")
    assert not any(layout.any_address for layout in layouts)
    assert read_can_log(tmp_path / "a.log").count == 80
