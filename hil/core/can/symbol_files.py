"""Reads symbols from an A2L, or from a CSV of a linker's map."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from hil.core.can.a2l import read_a2l
from hil.core.can.symbols import TYPES, Symbol, Symbols
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import read_bytes

_COLUMNS = ("symbol", "address", "type")
_MORE_COLUMNS = ("unit", "scale", "offset")
#: An A2L of an engine's control unit, the largest file that describes a device, has a quarter of this.
LARGEST_BYTES = 200_000_000
_HIGHEST_ADDRESS = 0xFFFF_FFFF


def read_symbols(path: Path) -> Symbols:
    """Read an A2L (`.a2l`) or a CSV with the columns symbol, address, type, unit, scale and offset.

    Raises:
        BadInputError: it cannot be read, or is neither.
    """
    data = read_bytes(path, LARGEST_BYTES)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # older tools write degrees and squares so
    if path.suffix.lower() == ".a2l":
        return replace(read_a2l(text, str(path)), file=path)
    if path.suffix.lower() == ".csv":
        return Symbols(dict(_rows(text, str(path))), file=path)
    raise BadInputError(
        "is not a table of symbols", where=str(path), fix="give an A2L (.a2l) or a CSV (.csv)"
    )


def _rows(text: str, where: str) -> list[tuple[str, Symbol]]:
    lines = csv.reader(io.StringIO(text))
    found: dict[str, Symbol] = {}
    try:
        header = [name.strip().lower() for name in next(lines, [])]
        missing = [name for name in _COLUMNS if name not in header]
        if missing:
            raise BadInputError(
                f"column '{missing[0]}' is missing",
                where=f"{where}, line 1",
                fix=f"begin it with: {','.join((*_COLUMNS, *_MORE_COLUMNS))}",
            )
        for row in lines:
            if not any(cell.strip() for cell in row):
                continue
            place = f"{where}, line {lines.line_num}"
            symbol = _symbol_of(dict(zip(header, (cell.strip() for cell in row), strict=False)), place)
            if symbol.name in found:
                raise BadInputError(
                    f"symbol '{printable(symbol.name, 60)}' stands twice", where=place, fix="leave one out"
                )
            found[symbol.name] = symbol
    except csv.Error as error:
        raise BadInputError(f"is no CSV: {error}", where=f"{where}, line {lines.line_num}") from error
    return list(found.items())


def _symbol_of(cells: Mapping[str, str], where: str) -> Symbol:
    kind = TYPES.get(cells.get("type", "").upper())
    if kind is None:
        raise BadInputError(
            f"type '{printable(cells.get('type', ''), 40)}' is none",
            where=where,
            fix=f"write one of {', '.join(TYPES)}",
        )
    name = cells.get("symbol", "")
    if not name:
        raise BadInputError("a symbol has no name", where=where, fix="write it in the column 'symbol'")
    try:
        address = int(cells.get("address", ""), 0)
    except ValueError:
        address = -1
    if not 0 <= address <= _HIGHEST_ADDRESS:
        raise BadInputError(
            f"address '{printable(cells.get('address', ''), 40)}' is none",
            where=where,
            fix="write it as 0x20000100",
        )
    scale, offset = (
        _number(cells, key, default, where) for key, default in (("scale", 1.0), ("offset", 0.0))
    )
    if scale == 0.0:
        raise BadInputError("scale is 0", where=where, fix="leave it empty for 1")
    return Symbol(name, address, kind, printable(cells.get("unit", ""), 20), scale, offset)


def _number(cells: Mapping[str, str], key: str, default: float, where: str) -> float:
    text = cells.get(key, "")
    try:
        value = float(text) if text else default
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise BadInputError(f"{key} '{printable(text, 40)}' is not a number", where=where, fix="correct it")
    return value
