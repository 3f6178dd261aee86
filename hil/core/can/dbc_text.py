"""The text of a DBC before it is parsed: what would cost a parser too much, or would have it give up.

A range of selector values (SG_MUL_VAL_) is kept as a range, for a parser makes a list of it. A message whose
identifier no frame can have is left out, for a parser refuses the whole file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

Ranges = tuple[tuple[int, int], ...]

_SELECTED = re.compile(r"^([ \t]*SG_MUL_VAL_[ \t]+(\d+)[ \t]+(\w+)[ \t]+\w+[ \t]+)([^;]*);", re.MULTILINE)
_RANGE = re.compile(r"(\d+)\s*-\s*(\d+)")
_MESSAGE = re.compile(r"^BO_[ \t]+(\d+)[ \t]+(\w+)[ \t]*:.*\r?\n(?:[ \t]+SG_.*\r?\n?)*", re.MULTILINE)
_EXTENDED_BIT, _LARGEST_EXTENDED, _LARGEST_STANDARD = 1 << 31, 0x1FFF_FFFF, 0x7FF
#: The message that tools keep signals in that are in no frame: a parser knows it.
_OF_NO_FRAME = 0xC000_0000


@dataclass(frozen=True)
class DbcText:
    """A text to be parsed.

    Attributes:
        ranges: of raw values of the selector, by identifier (as the DBC counts it) and signal.
        remarks: what was left out, a sentence each.
    """

    text: str
    ranges: Mapping[tuple[int, str], Ranges] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def prepared(text: str) -> DbcText:
    """What a parser is to be given."""
    ranges: dict[tuple[int, str], Ranges] = {}

    def shortened(found: re.Match[str]) -> str:
        pairs = tuple((int(low), int(high)) for low, high in _RANGE.findall(found[4]))
        key = int(found[2]), found[3]
        ranges[key] = (*ranges.get(key, ()), *pairs)
        return f"{found[1]}{', '.join(f'{low}-{low}' for low, _ in pairs)};" if pairs else found[0]

    text = _SELECTED.sub(shortened, text)
    impossible = {
        number: name
        for found in _MESSAGE.finditer(text)
        for number, name in [(int(found[1]), found[2])]
        if not _is_possible(number)
    }
    if impossible:
        text = _MESSAGE.sub(lambda found: "" if int(found[1]) in impossible else found[0], text)
        text = _lines_about(impossible).sub("", text)
    remarks = (
        f"message '{name}' has the identifier 0x{number & ~_EXTENDED_BIT:X}, {_why(number)}: left out"
        for number, name in impossible.items()
    )
    return DbcText(text, ranges, tuple(remarks))


def _is_possible(number: int) -> bool:
    if number == _OF_NO_FRAME:
        return True
    if number & _EXTENDED_BIT:
        return number & ~_EXTENDED_BIT <= _LARGEST_EXTENDED
    return number <= _LARGEST_STANDARD


def _why(number: int) -> str:
    if number & _EXTENDED_BIT:
        return "of more than 29 bits"
    return "of more than 11 bits, and is not marked as one of 29"


def _lines_about(numbers: Mapping[int, str]) -> re.Pattern[str]:
    """Comments, attributes, value tables and the like of messages."""
    one = "|".join(map(str, numbers))
    about = rf'(?:CM_|BA_ "\w+")[ \t]+(?:BO_|SG_)[ \t]+(?:{one})\b|VAL_[ \t]+(?:{one})\b'
    more = rf"(?:BO_TX_BU_|SIG_VALTYPE_|SIG_GROUP_|SG_MUL_VAL_)[ \t]+(?:{one})\b"
    return re.compile(rf'^[ \t]*(?:{about}|{more})(?:"(?:[^"\\]|\\.)*"|[^";])*;', re.MULTILINE)
