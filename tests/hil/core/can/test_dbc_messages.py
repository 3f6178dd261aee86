"""Every message of a DBC in whole columns, against cantools frame by frame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cantools
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.dbc_messages import decoded, read_messages_of
from hil.core.can.frames import ERROR_FRAME, EXTENDED, frames, joined
from hil.core.errors import BadInputError

DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 100 Plain: 8 A
 SG_ Low : 0|12@1- (0.5,-3) [0|0] "V" A
 SG_ High : 23|16@0+ (1,0) [0|0] "" A
BO_ 200 Many: 8 A
 SG_ Which M : 0|4@1+ (1,0) [0|0] "" A
 SG_ First m0 : 8|16@1+ (0.1,0) [0|0] "" A
 SG_ Inner m1M : 8|8@1+ (1,0) [0|0] "" A
 SG_ Deep m3 : 16|8@1- (1,0) [0|0] "" A
 SG_ Always : 48|16@1- (2,0) [0|0] "" A
BO_ 2147483748 Long: 2 A
 SG_ Count : 0|16@1+ (1,0) [0|0] "" A
BO_ 300 Wide: 24 A
 SG_ Far : 100|8@1+ (1,0) [0|0] "" A
BO_ 301 Exact: 8 A
 SG_ Too : 0|60@1+ (1,0) [0|0] "" A
SG_MUL_VAL_ 200 Inner Which 1-2;
SG_MUL_VAL_ 200 Deep Inner 3-3;
"""


@pytest.fixture(scope="module")
def dbc(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("dbc") / "a.dbc"
    path.write_text(DBC)
    return path


@given(payloads=st.lists(st.integers(0, (1 << 64) - 1), min_size=1, max_size=20))
def test_values_are_those_of_cantools(dbc: Path, payloads: list[int]) -> None:
    database: Any = cantools.database.load_file(dbc, strict=False)
    layouts, _ = read_messages_of(dbc)
    words = np.array(payloads, np.uint64) & np.uint64(0xFFFF_FFFF_FFFF_F3F3)  # selectors that often fit
    for name in ("Plain", "Many"):
        message = database.get_message_by_name(name)
        block = frames(message.frame_id, words, 8, np.arange(float(len(words))))
        (samples,) = decoded(block, layouts)
        for row, word in enumerate(words.tolist()):
            try:
                wanted = message.decode(word.to_bytes(8, "little"), decode_choices=False)
            except cantools.database.DecodeError:  # no signal for this selector: cantools gives none at all
                continue
            ours = {key: values[row] for key, values in samples.values.items() if not np.isnan(values[row])}
            assert ours == pytest.approx(wanted)


def test_a_number_of_29_bits_is_another_message_than_one_of_11(dbc: Path) -> None:
    layouts, _ = read_messages_of(dbc)
    block = joined(
        [
            frames(100, 5, 8, 0.0),
            frames(100, 7, 2, 1.0, flags=EXTENDED),
            frames(100, 9, 8, 2.0, flags=ERROR_FRAME),
            frames(100, 11, 2, 3.0),  # half a frame says what it holds
        ]
    )
    found = {samples.layout.name: samples for samples in decoded(block, layouts)}
    assert found["Plain"].time_s.tolist() == [0.0, 3.0]
    assert found["Plain"].short == 1
    assert found["Long"].values["Count"].tolist() == [7.0]
    assert found.keys() == {"Plain", "Long"}


def test_what_has_no_place_in_a_recording_is_said(dbc: Path) -> None:
    layouts, remarks = read_messages_of(dbc)
    assert [message.name for message in layouts] == ["Plain", "Many", "Long"]
    assert remarks == [
        "message 'Wide' has 24 bytes: its frames are left out",
        "message 'Exact', signal 'Too' is an integer of 60 bits; at most 53 are counted exactly: left out",
    ]


def test_a_dbc_without_signals_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.dbc"
    path.write_text('VERSION ""\nNS_ :\nBS_:\nBU_: A\nBO_ 100 Plain: 8 A\n')
    with pytest.raises(BadInputError, match="no message with a signal"):
        read_messages_of(path)


BRANCHES = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 800 Pair: 7 A
 SG_ Sel M : 0|8@1+ (1,0) [0|0] "" A
 SG_ First m0 : 8|8@1+ (1,0) [0|0] "" A
 SG_ First m1 : 16|8@1+ (1,0) [0|0] "" A
 SG_ Last m1 : 48|8@1+ (1,0) [0|0] "" A
BO_ 100 Wide: 3 A
 SG_ Page M : 0|8@1+ (1,0) [0|0] "" A
 SG_ Level m0 : 8|16@1+ (1,0) [0|0] "" A
BO_ 3000 Odd: 3 A
 SG_ x : 0|8@1+ (1,0) [0|0] "" A

CM_ SG_ 3000 x "a comment; of what is left out";
SG_MUL_VAL_ 100 Level Page 7-200000000, 2-3;
"""


def test_one_name_in_two_branches_is_one_channel(tmp_path: Path) -> None:
    (tmp_path / "a.dbc").write_text(BRANCHES)
    layouts, remarks = read_messages_of(tmp_path / "a.dbc")
    (remark,) = remarks
    assert "message 'Odd' has the identifier 0xBB8, of more than 11 bits" in remark
    block = joined([frames(800, 0x1E140A00, 7, 0.0), frames(800, 0x05000000140A01, 7, 1.0)])
    (samples,) = decoded(block, layouts)
    assert samples.values["First"].tolist() == [10.0, 20.0]
    assert samples.short == 0
    cut = joined([frames(800, 0x0A00, 2, 0.0), frames(800, 0x140A01, 3, 1.0)])  # the second lacks Last
    (samples,) = decoded(cut, layouts)
    assert samples.values["First"].tolist() == [10.0, 20.0]
    assert np.isnan(samples.values["Last"]).all()
    assert samples.short == 1


def test_a_range_of_selector_values_costs_no_list_of_them(tmp_path: Path) -> None:
    (tmp_path / "a.dbc").write_text(BRANCHES)
    layouts, _ = read_messages_of(tmp_path / "a.dbc")
    words = [0x6400 | page for page in (2, 3, 4, 7, 255)]
    (samples,) = decoded(frames(100, np.array(words, np.uint64), 3, np.arange(5.0)), layouts)
    assert np.isnan(samples.values["Level"]).tolist() == [False, False, True, False, False]
