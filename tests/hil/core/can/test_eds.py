"""EDS files that cannot be used: each is refused with file and object."""

import os
from pathlib import Path
from typing import Any

import pytest
from canopen.objectdictionary import ObjectDictionary, ODRecord, ODVariable
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.core.can.eds import identifier_of, layout_of_pdo, read_eds
from hil.core.errors import BadInputError

BENCHES = Path(__file__).parents[4] / "benches"
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


def test_every_type_of_cia_301_has_its_bits_and_its_sign() -> None:
    # CiA 301, table 44: name, code, bits
    signed = [(0x02, 8), (0x03, 16), (0x10, 24), (0x04, 32), (0x12, 40), (0x13, 48), (0x14, 56), (0x15, 64)]
    unsigned = [(0x05, 8), (0x06, 16), (0x16, 24), (0x07, 32), (0x18, 40), (0x19, 48), (0x1A, 56), (0x1B, 64)]
    for kinds, minus, point in (
        (signed, True, False),
        (unsigned, False, False),
        ([(8, 32), (0x11, 64)], False, True),
    ):
        for code, bits in kinds:
            signal = one_signal(code, bits)
            assert (signal.length, signal.signed, signal.is_float) == (bits, minus, point)
            with pytest.raises(BadInputError, match=f"which has {bits}"):
                one_signal(code, bits - 1)


def test_a_part_of_a_record_is_mapped_by_its_subindex() -> None:
    dictionary = ObjectDictionary()
    record = ODRecord("Record", 0x2000)
    for subindex, name in ((1, "First"), (3, "Third")):
        value = ODVariable(name, 0x2000, subindex)
        value.data_type = 7
        record.add_member(value)
    dictionary.add_object(record)
    assert mapped(dictionary, 0x2000 << 16 | 3 << 8 | 32).name == "Third"


def one_signal(code: int, bits: int) -> Any:
    dictionary = ObjectDictionary()
    value = ODVariable("Value", 0x2000)
    value.data_type = code
    dictionary.add_object(value)
    return mapped(dictionary, 0x2000 << 16 | bits)


def mapped(dictionary: ObjectDictionary, what: int) -> Any:
    """The signal of a PDO that maps one object."""
    mapping = ODRecord("Mapping", 0x1A00)
    for subindex, default in ((0, 1), (1, what)):
        entry = ODVariable("Entry", 0x1A00, subindex)
        entry.default = default
        mapping.add_member(entry)
    dictionary.add_object(mapping)
    (signal,) = layout_of_pdo(dictionary, 0x1A00, 0x180).signals.values()
    return signal


def with_entry(text: str, section: str, line: str) -> str:
    """The shipped EDS with another DefaultValue line in a section."""
    head, mark, tail = text.partition(f"[{section}]")
    assert mark
    own, end, rest = tail.partition("\n[")
    lines = [line if one.startswith("DefaultValue=") else one for one in own.splitlines()]
    return head + mark + "\n".join(lines) + end + rest


@pytest.mark.parametrize(
    ("section", "line", "said"),
    [
        ("1A00sub1", "DefaultValue=", "0x1A00 sub 1: has no value"),
        (
            "1A00sub1",
            "DefaultValue=0x21010020h",
            "0x1A00 sub 1: a mapped object is '0x21010020h', no whole number",
        ),
        ("1A00sub1", "DefaultValue=553713696.0", "0x1A00 sub 1: a mapped object is '553713696.0'"),
        ("1A00sub2", "DefaultValue=0", "0x1A00 sub 2: is 0 and maps nothing"),
        ("1A00sub0", "DefaultValue=two", "0x1A00 sub 0: the number of mapped objects is 'two'"),
    ],
)
def test_an_entry_that_cannot_be_read_moves_nothing_up(section, line, said, tmp_path):
    assert said in refused(with_entry(TEXT, section, line), tmp_path)


def test_the_value_of_a_dcf_is_what_the_device_has(tmp_path):
    path = tmp_path / "some.dcf"
    path.write_text(TEXT.replace("[1A00sub1]", "[1A00sub1]\nParameterValue=0x21020020"))
    with pytest.raises(BadInputError, match="does not map 'Wheel speed'"):
        layout(path)


def test_pdos_are_where_the_file_says(tmp_path):
    def identifier(line: str) -> int:
        path = tmp_path / "some.eds"
        path.write_text(with_entry(TEXT, "1800sub1", line))
        return identifier_of(read_eds(path, 3, OBJECTS, FLOATS), 0x1800, 0x183, str(path))

    assert identifier("DefaultValue=$NODEID+0x180") == 0x183
    assert identifier("DefaultValue=0x3A1") == 0x3A1
    assert identifier("DefaultValue=0x400003A1") == 0x3A1  # it cannot be asked for
    with pytest.raises(BadInputError, match=r"0x1800 sub 1: the COB-ID is 0x800003A1: .*switched off"):
        identifier("DefaultValue=0x800003A1")
    with pytest.raises(BadInputError, match="of 29 bits"):
        identifier("DefaultValue=0x200003A1")
    with pytest.raises(BadInputError, match="the COB-ID is 'here', no whole number"):
        identifier("DefaultValue=here")


def test_a_number_with_zeros_before_it_condemns_nothing(tmp_path):
    path = tmp_path / "some.eds"
    path.write_text(TEXT.replace("VendorNumber=0", "VendorNumber=001"))
    assert "Wheel speed" in layout(path).signals
