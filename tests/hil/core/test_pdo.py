"""EDS files that cannot be used: each is refused with file and object."""

import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.core.pdo import layout_of_pdo, read_eds

BENCHES = Path(__file__).parents[3] / "benches"
TEXT = (BENCHES / "rcs_dyno.eds").read_text()
OBJECTS = ((0x1016, 1), (0x6060, 0))
FLOATS = ((0x2000, 1),)


def layout(path, needed=("Wheel speed", "Shaft torque")):
    return layout_of_pdo(read_eds(path, 3, OBJECTS, FLOATS), 0x1A00, 0x183, needed, str(path))


def refused(content, tmp_path):
    path = tmp_path / "some.eds"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(BadInputError) as caught:
        layout(path)
    error = caught.value
    assert error.where.startswith(str(path))
    assert error.fix
    assert all(c.isprintable() for c in str(error).replace("\n", ""))
    return str(error)


def test_the_shipped_eds_gives_layouts():
    assert [(s.shift, s.length, s.scale) for s in layout(BENCHES / "rcs_dyno.eds").signals.values()] == [
        (0, 32, 1e-5),
        (32, 32, 0.001),
    ]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[1A00]", "[1B00]", "0x1A00: is missing"),
        ("[2000sub1]", "[2000sub9]", "has no object 0x2000 sub 1"),
        ("[6060]", "[6F60]", "has no object 0x6060"),
        ("0x21010020", "0x2ABC0020", "0x1A00: maps 0x2ABC"),
        ("0x21010020", "0x21010010", "maps 16 bits of 'Wheel speed', which has 32"),
        ("0x21010020", "0x20000120", "does not map 'Wheel speed'"),
        ("ParameterName=Wheel speed", "ParameterName=Raddrehzahl", "does not map 'Wheel speed'"),
    ],
)
def test_what_is_missing_is_told_with_the_object(old, new, said, tmp_path):
    assert old in TEXT
    text = TEXT.replace(old, new)
    if old == "[1A00]":
        text = text.replace("[1A00sub", "[1B00sub")
    assert said in refused(text, tmp_path)


def test_a_factor_of_zero_is_refused(tmp_path):
    at = TEXT.index("[2101]")
    text = TEXT[:at] + TEXT[at:].replace("Factor=1e-05", "Factor=0", 1)
    assert "'Wheel speed' has the factor 0" in refused(text, tmp_path)


def test_an_integer_where_a_float_is_written_is_refused(tmp_path):
    at = TEXT.index("[2000sub1]")
    text = TEXT[:at] + TEXT[at:].replace("DataType=0x0008", "DataType=0x0007", 1)
    assert "0x2000 sub 1 is no IEEE float" in refused(text, tmp_path)


@pytest.mark.parametrize(
    "content",
    [b"", b"hello\nthere", b"\0\1\x1b[31m" * 99, (BENCHES / "rmcu.dbc").read_bytes(), b"[a]\nb=c\n"],
)
def test_another_kind_of_file_is_refused(content, tmp_path):
    assert "not an EDS file" in refused(content, tmp_path)


@settings(max_examples=50)
@given(data=st.data())
def test_a_damaged_eds_is_read_or_refused_but_never_more(data):
    content = bytearray(TEXT.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    path = Path(os.environ.get("TMPDIR", "/tmp")) / f"damaged-{os.getpid()}.eds"
    path.write_bytes(bytes(content))
    try:
        layout(path)
    except BadInputError:
        pass
    finally:
        path.unlink()
