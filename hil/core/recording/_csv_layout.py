"""How the CSV of another tool is laid out: separators, decimal comma, units. Nothing is guessed."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from hil.core.channels import CHANNELS, TIME
from hil.core.errors.wording import repeated
from hil.core.units import Conversion, UnitError, conversion, has_unit, is_spelled

#: Spellings of time's unit, and how many of it are a second.
_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
_SEPARATORS = {",": "comma", ";": "semicolon", "\t": "tab", "|": "bar"}
_NAMED_WITH_UNIT = re.compile(r"(.+?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]")
_TIME_NAMES = ("time", "t", "timestamp", "timestamps")
_SPELLINGS = {"sec": "s", "second": "s", "seconds": "s", "msec": "ms", "μs": "us", "µs": "us", "usec": "us"}
_SEPARATOR_LINE = re.compile(rb"\"?sep=(.|\t)\"?", re.IGNORECASE)
_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+")


class LayoutError(ValueError):
    """What of a layout cannot be read without guessing, and what to do."""

    def __init__(self, what: str, fix: str, column: str = "") -> None:
        super().__init__(what)
        self.what, self.fix, self.column = what, fix, column


@dataclass
class Layout:
    """Names of the columns ('' for none) and how cells are separated; `units` stand by the names, or ''."""

    names: list[str]
    separator: str = ","
    decimal: str = "."
    units: list[str] = field(default_factory=list)
    per_second: float = 1.0
    conversions: dict[int, Conversion] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def cells(self, line: str) -> list[str]:
        """The cells of a line."""
        if '"' not in line:
            return line.split(self.separator)
        return next(csv.reader([line], delimiter=self.separator, skipinitialspace=True), [])

    def take_units(self, units: Sequence[str]) -> None:
        """Take units that stand by the names or in a line of their own.

        Raises:
            LayoutError: a channel is in a unit that cannot be converted to its own.
        """
        for column, (name, unit) in enumerate(zip(self.names, units, strict=True)):
            spelled = _plain(unit)
            if not spelled or name not in CHANNELS:
                continue
            if name == TIME:
                self._take_time(column, spelled, unit)
            elif has_unit(unit):
                self._convert(column, unit)

    def _convert(self, column: int, unit: str) -> None:
        name = self.names[column]
        own = CHANNELS[name].unit
        try:
            found = conversion(unit, own)
        except UnitError as error:
            raise LayoutError(error.what, error.fix, name) from None
        if not found.is_none:
            self.conversions[column] = found
            self.notes.append(f"'{name}' was converted from {unit.strip().strip('[]()')} to {own}")

    def _take_time(self, column: int, spelled: str, unit: str) -> None:
        if spelled not in _PER_SECOND:
            raise LayoutError(f"is in '{unit}'", f"known: {', '.join(_PER_SECOND)}", TIME)
        if self.units[column] and self.units[column] != spelled:
            raise LayoutError(
                f"is in {self.units[column]} by its name and in '{unit}' beside it",
                "name it time_s, time_ms, time_us or time_ns, or mend the unit",
                TIME,
            )
        self.units[column] = spelled
        self.per_second = _PER_SECOND[spelled]

    def is_of_units(self, cells: Sequence[str]) -> bool:
        """Whether the line below the names gives their units."""
        known = [unit for name, unit in zip(self.names, map(_plain, cells), strict=True) if name in CHANNELS]
        spelled = any(known) and all(not unit or is_spelled(unit) for unit in known)
        return spelled and not any(map(_number, cells))

    def settle_decimal(self, rows: Sequence[Sequence[str]]) -> None:
        """Find out whether numbers have a decimal comma, from some rows.

        Raises:
            LayoutError: it cannot be known.
        """
        columns = [column for column, name in enumerate(self.names) if name in CHANNELS]
        cells = [(row[c].strip(), self.names[c]) for row in rows for c in columns if c < len(row)]
        commas = [(cell, name) for cell, name in cells if "," in cell]
        if not commas or self.separator == ",":
            return
        points = next(((cell, name) for cell, name in cells if "." in cell), None)
        if points is not None:
            cell, name = points
            raise LayoutError(
                f"'{cell}' has a point and '{commas[0][0]}' a comma",
                "write numbers with one decimal sign and without thousands separators",
                name,
            )
        if all(_GROUPED.fullmatch(cell) for cell, _ in commas):
            cell, name = commas[0]
            raise LayoutError(
                f"'{cell}' may be {cell.replace(',', '.')} or {cell.replace(',', '')}",
                "write numbers with a decimal point",
                name,
            )
        self.decimal = ","
        self.notes.append("numbers have a decimal comma")


def names_separator(line: bytes) -> bool:
    """Whether a first line is no header, but tells Excel the separator: `sep=;`."""
    return _SEPARATOR_LINE.fullmatch(line.strip()) is not None


def layout_of(header: str) -> Layout:
    """The layout that a header line shows.

    Raises:
        LayoutError: it names no time, or two of its names are one.
    """
    for separator, word in _SEPARATORS.items():
        found = Layout([], separator)
        cells = [cell.strip() for cell in found.cells(header)]
        named = [_name_and_unit(cell) for cell in cells]
        if any(name == TIME for name, _, _ in named):
            found.names = [name for name, _, _ in named]
            found.units = [unit if name == TIME else "" for name, unit, _ in named]
            _settle_header(found, cells, [beside for _, _, beside in named])
            other = next((c for c, n in zip(cells, found.names, strict=True) if n == c.lower() != c), None)
            if other is not None:
                found.notes.append(f"'{other}' was read as '{other.lower()}', others likewise")
            if separator != ",":
                found.notes.insert(0, f"columns are separated by {word}s")
            return found
        if any(cell.lower() in _TIME_NAMES for cell in cells):
            raise LayoutError(
                f"the header line has no '{TIME}', and its '{_time_like(cells)}' has no unit",
                "name it time_s, time_ms, time_us or time_ns",
            )
    raise LayoutError(f"the header line has no '{TIME}'", "the first line names the channels")


def _settle_header(found: Layout, cells: list[str], beside: list[str]) -> None:
    duplicate = repeated(name for name in found.names if name)
    if duplicate:
        raise LayoutError(f"column '{duplicate[0]}' stands twice", "leave one of them out")
    time = found.names.index(TIME)
    if found.units[time]:
        found.per_second = _PER_SECOND[found.units[time]]
    found.take_units(beside)
    if found.per_second != 1.0:
        found.notes.append(f"'{cells[time]}' was converted from {found.units[time]} to s")


def _name_and_unit(cell: str) -> tuple[str, str, str]:
    """A column's name, the unit of time that its name says, and the unit that stands beside it."""
    whole = _NAMED_WITH_UNIT.fullmatch(cell)
    name, beside = (whole[1], whole[2]) if whole else (cell, "")
    if name.lower() in _TIME_NAMES and _plain(beside) in _PER_SECOND:
        return TIME, "", beside
    head, _, unit = name.rpartition("_")
    if head.lower() == "time" and _plain(unit) in _PER_SECOND:
        return TIME, _plain(unit), beside
    # what is no channel keeps its name as it is
    return (name.lower(), "", beside) if name.lower() in CHANNELS else (cell, "", "")


def _time_like(cells: list[str]) -> str:
    return next(cell for cell in cells if cell.lower() in _TIME_NAMES)


def _plain(unit: str) -> str:
    plain = unit.strip().strip("[]()").replace("·", "").replace("*", "").replace(" ", "").lower()
    return _SPELLINGS.get(plain, plain)


def _number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return cell.strip() not in ("1",)  # a number without unit may have the unit 1
