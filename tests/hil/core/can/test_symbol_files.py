"""Tables of symbols: what stands in an A2L or a CSV, and what is refused with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.symbol_files import read_symbols
from hil.core.can.symbols import TYPES, Symbol
from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import shipped

A2L = """ASAP2_VERSION 1 61
/* a comment with /begin in it */
/begin PROJECT p "a text with \\" in it"
  /begin MODULE m ""
    /begin MOD_PAR "" EPK "SW 7" ADDR_EPK 0x1000 /end MOD_PAR
    /begin MOD_COMMON "" BYTE_ORDER MSB_FIRST /end MOD_COMMON
    /begin IF_DATA XCP /begin XCP_ON_CAN 0x0100 CAN_ID_MASTER 0x321 CAN_ID_SLAVE 802 /end XCP_ON_CAN
    /end IF_DATA
    /begin COMPU_METHOD linear "" LINEAR "%6.2" "rad/s" COEFFS_LINEAR 0.5 -10 /end COMPU_METHOD
    /begin COMPU_METHOD ratio "" RAT_FUNC "%6.2" "N m" COEFFS 0 4 8 0 0 2 /end COMPU_METHOD
    /begin COMPU_METHOD square "" RAT_FUNC "%6.2" "1" COEFFS 1 4 8 0 0 2 /end COMPU_METHOD
    /begin COMPU_METHOD words "" TAB_VERB "%6.2" "" COMPU_TAB_REF t /end COMPU_METHOD
    /begin MEASUREMENT speed "LINEAR"  // another
      UWORD linear 0 0 0 100 ECU_ADDRESS 0x2000 ECU_ADDRESS_EXTENSION 1 /end MEASUREMENT
    /begin MEASUREMENT torque "" SLONG ratio 0 0 0 100 ECU_ADDRESS 0x2004 PHYS_UNIT "Nm" BYTE_ORDER MSB_LAST
      /begin IF_DATA XCP ECU_ADDRESS 1 /end IF_DATA /end MEASUREMENT
    /begin MEASUREMENT squared "" UBYTE square 0 0 0 100 ECU_ADDRESS 0x2008 /end MEASUREMENT
    /begin MEASUREMENT state "" UBYTE words 0 0 0 100 ECU_ADDRESS 0x2009 /end MEASUREMENT
    /begin MEASUREMENT several "" UBYTE NO_COMPU_METHOD 0 0 0 100 ECU_ADDRESS 0x2009 ARRAY_SIZE 4
    /end MEASUREMENT
    /begin MEASUREMENT nowhere "" FLOAT32_IEEE NO_COMPU_METHOD 0 0 0 100 /end MEASUREMENT
  /end MODULE
/end PROJECT
"""
CSV = "symbol,address,type,unit,scale,offset\nspeed,0x2000,UWORD,rad/s,0.5,-10\n\nraw,8196,float32_ieee,,,\n"


def written(folder: Path, text: str, suffix: str = ".a2l") -> Path:
    path = folder / f"symbols{suffix}"
    path.write_text(text)
    return path


def test_an_a2l_gives_what_measuring_needs(tmp_path: Path) -> None:
    symbols = read_symbols(written(tmp_path, A2L))
    assert (symbols.order, symbols.request_id, symbols.answer_id) == (">", 0x321, 802)
    assert (symbols.software, symbols.software_address) == ("SW 7", 0x1000)
    assert symbols.find("speed") == Symbol("speed", 0x2000, "u2", "rad/s", 0.5, -10.0, 1)
    # raw = (4 x + 8)/2
    assert symbols.find("torque") == Symbol("torque", 0x2004, "i4", "Nm", 0.5, -2.0, 0, "<")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("squared", "not linear"),
        ("state", "not linear"),
        ("several", "is an array"),
        ("nowhere", "has no address"),
        ("sped", "did you mean 'speed'?"),
    ],
)
def test_what_cannot_be_measured_says_why(tmp_path: Path, name: str, said: str) -> None:
    with pytest.raises(BadInputError, match=said.replace("?", r"\?")):
        read_symbols(written(tmp_path, A2L)).find(name)


def test_a_table_gives_the_same(tmp_path: Path) -> None:
    symbols = read_symbols(written(tmp_path, CSV, ".csv"))
    assert symbols.find("speed") == Symbol("speed", 0x2000, "u2", "rad/s", 0.5, -10.0)
    assert symbols.find("raw") == Symbol("raw", 8196, "f4")


@pytest.mark.parametrize(
    ("text", "suffix", "said"),
    [
        (A2L.replace("/end MODULE", ""), ".a2l", "'/end PROJECT' does not end 'MODULE' of line 4"),
        (A2L.rpartition("/end")[0], ".a2l", "'PROJECT' of line 3 does not end"),
        (A2L.replace("0x2008", '"'), ".a2l", "does not end"),
        ("nothing", ".a2l", "has no PROJECT"),
        (
            A2L.replace("FLOAT32_IEEE NO_COMPU_METHOD 0 0 0 100", "1"),
            ".a2l",
            "line 21: a MEASUREMENT is not whole",
        ),
        (CSV.replace("address", "place"), ".csv", "line 1: column 'address' is missing"),
        (CSV.replace("0x2000", "here"), ".csv", "line 2: address 'here' is none"),
        (CSV.replace("UWORD", "WORD"), ".csv", "line 2: type 'WORD' is none"),
        (CSV.replace("0.5", "0"), ".csv", "line 2: scale is 0"),
        (CSV.replace("0.5", "nan"), ".csv", "line 2: scale 'nan' is not a number"),
        (CSV.replace("raw", "speed"), ".csv", "line 4: symbol 'speed' stands twice"),
        (CSV, ".map", "is not a table of symbols"),
    ],
)
def test_a_file_that_is_none_is_told_with_its_line(tmp_path: Path, text: str, suffix: str, said: str) -> None:
    with pytest.raises(BadInputError) as refused:
        read_symbols(written(tmp_path, text, suffix))
    assert said in str(refused.value)


def test_the_shipped_a2l_can_be_measured_whole() -> None:
    symbols = read_symbols(shipped("rmcu.a2l"))
    assert len(symbols.by_name) == 12
    assert all(symbols.find(name).kind == "f4" for name in symbols.by_name)


@given(
    kind=st.sampled_from(list(TYPES.values())),
    order=st.sampled_from("<>"),
    scale=st.floats(1e-3, 1e3),
    offset=st.floats(-1e3, 1e3),
    raw=st.integers(-(2**31), 2**31 - 1),
)
def test_what_stands_in_memory_is_read_back(
    kind: str, order: str, scale: float, offset: float, raw: int
) -> None:
    symbol = Symbol("s", 0, kind, "", scale, offset)
    dtype = np.dtype(kind)
    if dtype.kind in "iu":
        ends = np.iinfo(kind)
        raw = min(max(raw, int(ends.min)), int(ends.max))
    value = np.array([float(dtype.type(raw)) * scale + offset])
    memory = symbol.raw(value, order)
    assert memory.shape == (1, symbol.size)
    assert symbol.values(memory, order) == pytest.approx(value, rel=1e-6, abs=1e-3 * scale)


@given(st.sampled_from(list(TYPES.values())), st.floats(-1e30, 1e30))
def test_no_value_is_beyond_its_type(kind: str, value: float) -> None:
    symbol = Symbol("s", 0, kind)
    back = symbol.values(symbol.raw(np.array([value]), "<"), "<")[0]
    if np.dtype(kind).kind in "iu":
        assert float(np.iinfo(kind).min) <= back <= float(np.iinfo(kind).max)
        assert np.sign(back) in (0.0, np.sign(value))


@given(st.text(st.sampled_from('/begin end "MEASUREMENT\\*PROJECT\n x0'), max_size=60))
def test_any_text_is_read_or_refused(text: str) -> None:
    from hil.core.can.a2l import read_a2l

    try:
        read_a2l(text, "file")
    except BadInputError as refused:
        assert refused.where.startswith("file")
