"""What measuring needs of an A2L (ASAM MCD-2 MC): measurements, linear conversions, XCP's identifiers.

The rest of the file is walked over, not understood. The kept readers are under the GPL.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from hil.core.can.symbols import TYPES, Symbol, Symbols
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable

_TOKEN = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:[^"\\]|\\.|"")*"|[^\s"]+|"', re.DOTALL)
# BIG_ENDIAN and LITTLE_ENDIAN are old words that tools take either way: the slave says it itself.
_ORDERS = {"MSB_LAST": "<", "MSB_FIRST": ">"}
_XCP = ("XCP", "XCPplus")
_DEEPEST = 100


@dataclass
class _Block:
    """`/begin KEYWORD … /end KEYWORD`: its own words, and the blocks in it."""

    keyword: str
    line: int
    words: list[str] = field(default_factory=list)
    blocks: list[_Block] = field(default_factory=list)

    def after(self, keyword: str, count: int = 1, first: int = 0) -> list[str] | None:
        """The words behind a keyword that stands at word `first` or later; None if there is none."""
        if keyword not in self.words[first:]:
            return None
        at = self.words.index(keyword, first) + 1
        return self.words[at : at + count] if at + count <= len(self.words) else None

    def all(self, keyword: str) -> Iterator[_Block]:
        """Every block of a kind in it, however deep."""
        for block in self.blocks:
            if block.keyword == keyword:
                yield block
            yield from block.all(keyword)


def read_a2l(text: str, where: str) -> Symbols:
    """Read the text of an A2L.

    Raises:
        BadInputError: it is none, or a measurement in it has no address, type or name.
    """
    whole = _parsed(text, where)
    if not any(block.keyword == "PROJECT" for block in whole.blocks):
        raise BadInputError("has no PROJECT", where=where, fix="is it an A2L?")
    conversions = {block.words[0]: block for block in whole.all("COMPU_METHOD") if block.words}
    found: dict[str, Symbol] = {}
    for block in whole.all("MEASUREMENT"):
        symbol = _measurement(block, conversions, where)
        found.setdefault(symbol.name, symbol)
    ids = {key: _number_after(whole, key) for key in ("CAN_ID_MASTER", "CAN_ID_SLAVE")}
    software = _of(whole, "MOD_PAR", "EPK")
    address = _integer(_of(whole, "MOD_PAR", "ADDR_EPK"))
    return Symbols(
        found,
        order=_ORDERS.get(_of(whole, "MOD_COMMON", "BYTE_ORDER"), ""),
        request_id=ids["CAN_ID_MASTER"],
        answer_id=ids["CAN_ID_SLAVE"],
        software=software,
        software_address=address if software else None,
    )


def _words(text: str) -> Iterator[tuple[int, str]]:
    """Words and strings with their line; comments are left out, quotation marks are kept."""
    line, seen = 1, 0
    for match in _TOKEN.finditer(text):
        line += text.count("\n", seen, match.start())
        seen = match.start()
        word = match[0]
        if not word.startswith(("/*", "//")):
            yield line, word


def _parsed(text: str, where: str) -> _Block:
    open_ = [_Block("", 1)]
    words = _words(text)
    for line, word in words:
        if word == '"':
            raise BadInputError("a text does not end", where=f"{where}, line {line}", fix='it wants its "')
        if word in ("/begin", "/end"):
            keyword = next(words, (line, ""))[1]
            if word == "/begin":
                if len(open_) > _DEEPEST:
                    raise BadInputError("blocks stand too deep in each other", where=f"{where}, line {line}")
                open_.append(_Block(keyword, line))
                open_[-2].blocks.append(open_[-1])
            elif keyword != open_[-1].keyword or len(open_) == 1:
                opened = f"'{printable(open_[-1].keyword, 40)}' of line {open_[-1].line}"
                ended = opened if len(open_) > 1 else "anything"
                raise BadInputError(
                    f"'/end {printable(keyword, 40)}' does not end {ended}",
                    where=f"{where}, line {line}",
                    fix="is the file whole?",
                )
            else:
                open_.pop()
        else:
            open_[-1].words.append(word)
    if len(open_) > 1:
        raise BadInputError(
            f"'{printable(open_[-1].keyword, 40)}' of line {open_[-1].line} does not end",
            where=where,
            fix="is the file whole?",
        )
    return open_[0]


def _measurement(block: _Block, conversions: dict[str, _Block], where: str) -> Symbol:
    """name, "description", type, conversion, resolution, accuracy, lowest, highest; then what may be."""
    place = f"{where}, line {block.line}"
    if len(block.words) < 8:
        raise BadInputError("a MEASUREMENT is not whole", where=place, fix="is the file whole?")
    name, _, type_, method = block.words[:4]
    addresses = block.after("ECU_ADDRESS", 1, 8)
    address = _integer(addresses[0]) if addresses else None
    order = _ORDERS.get((block.after("BYTE_ORDER", 1, 8) or [""])[0], "")
    unusable = ""
    if address is None:
        unusable = "has no address"
    elif type_ not in TYPES:
        unusable = f"is of type {printable(type_, 40)}"
    elif block.after("BYTE_ORDER", 1, 8) and not order:
        unusable = "has a byte order of its own that is not MSB_FIRST or MSB_LAST"
    elif any(block.after(key, 1, 8) for key in ("ARRAY_SIZE", "MATRIX_DIM", "BIT_MASK")):
        unusable = "is an array or some bits of a word"
    scale, offset, unit, problem = _conversion(method, conversions)
    units = block.after("PHYS_UNIT", 1, 8)
    extension = block.after("ECU_ADDRESS_EXTENSION", 1, 8)
    return Symbol(
        name,
        address or 0,
        TYPES.get(type_, "u1"),
        _plain(units[0]) if units else unit,
        scale,
        offset,
        (_integer(extension[0]) or 0) & 0xFF if extension else 0,
        order,
        unusable or problem,
    )


def _conversion(method: str, conversions: dict[str, _Block]) -> tuple[float, float, str, str]:
    """Scale, offset and unit of a conversion, and why it cannot be used."""
    if method == "NO_COMPU_METHOD":
        return 1.0, 0.0, "", ""
    block = conversions.get(method)
    if block is None or len(block.words) < 5:
        return 1.0, 0.0, "", f"is converted by '{printable(method, 40)}', which the file has not"
    kind, unit = block.words[2], _plain(block.words[4])
    try:
        if kind == "IDENTICAL":
            return 1.0, 0.0, unit, ""
        if kind == "LINEAR":
            scale, offset = map(float, block.after("COEFFS_LINEAR", 2, 5) or ())
            if scale and math.isfinite(scale) and math.isfinite(offset):
                return scale, offset, unit, ""
        if kind == "RAT_FUNC":
            # raw = (a x² + b x + c)/(d x² + e x + f)
            a, b, c, d, e, f = map(float, block.after("COEFFS", 6, 5) or ())
            if a == d == e == 0.0 and b and f and math.isfinite(f / b) and math.isfinite(c / b):
                return f / b, -c / b, unit, ""
    except ValueError:
        pass
    return 1.0, 0.0, unit, f"is converted by '{printable(method, 40)}', which is not linear"


def _of(whole: _Block, keyword: str, key: str) -> str:
    """The word behind a key in the first block of a kind; '' if there is none."""
    for block in whole.all(keyword):
        found = block.after(key)
        if found:
            return _plain(found[0])
    return ""


def _number_after(whole: _Block, key: str) -> int | None:
    """The number behind a key in what the file says of XCP."""
    for data in whole.all("IF_DATA"):
        if data.words[:1] and data.words[0] in _XCP:
            for block in (data, *data.all("XCP_ON_CAN")):
                found = block.after(key)
                if found:
                    return _integer(found[0])
    return None


def _integer(text: str) -> int | None:
    try:
        return int(text, 0)
    except ValueError:
        return None


def _plain(word: str) -> str:
    """A text without its quotation marks."""
    return printable(word.strip('"').replace('""', '"'), 100)
