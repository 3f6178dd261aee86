"""How a table of text is laid out: Unicode, separators, decimal comma, units, rows below its names."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import BinaryIO, cast

from hil.core.channels import CHANNELS, TIME
from hil.core.recording._assigned import Assigned
from hil.core.recording._column_map import OPTION
from hil.core.recording._time_stamps import TimeStamps, is_stamp, kind_of
from hil.core.units import Conversion, UnitError, conversion, has_unit, is_spelled

_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def as_utf8(file: BinaryIO) -> BinaryIO:
    """The file, or what reads it as UTF-8 where its first bytes say that it is UTF-16.

    Reading it raises UnicodeError where it is not what its first bytes say.
    """
    mark = file.read(2)
    file.seek(0)
    if mark not in _MARKS:
        return file
    return cast(BinaryIO, codecs.EncodedFile(cast("codecs._Stream", file), "utf-8", "utf-16"))


#: Spellings of time's unit, and how many of it are a second.
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
_SPELLINGS = {"sec": "s", "second": "s", "seconds": "s", "msec": "ms", "μs": "us", "µs": "us", "usec": "us"}
_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+")


class LayoutError(ValueError):
    """What of a layout cannot be read without guessing, and what to do."""

    def __init__(self, what: str, fix: str, column: str = "") -> None:
        super().__init__(what)
        self.what, self.fix, self.column = what, fix, column
        self.line = 0  # below the first that was looked at


@dataclass
class Layout:
    """Names of the columns ('' for none), how cells are separated, and the unit in the name of time.

    `assigned` is there if a map of columns was given; `stamps` read a time that is text; a line has
    `cells_expected`, of which those behind the names are blank.
    """

    names: list[str]
    separator: str = ","
    decimal: str = "."
    units: list[str] = field(default_factory=list)
    per_second: float = 1.0
    conversions: dict[int, Conversion] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    assigned: Assigned | None = None
    stamps: TimeStamps | None = None
    cells_expected: int = 0

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
            spelled = plain_unit(unit)
            if self.assigned is not None and (name in CHANNELS or name in self.assigned.columns.sources):
                self._keep(name, unit.strip().strip('"'))
                continue
            if not spelled or name not in CHANNELS:
                continue
            if name == TIME and ":" not in unit:
                self._take_time(column, spelled, unit)
            elif name != TIME and has_unit(unit):
                self._convert(column, unit)

    def _keep(self, name: str, unit: str) -> None:
        """Take the unit of a channel of a map, to be converted with all that the map says."""
        assert self.assigned is not None
        if not has_unit(unit) or (name == TIME and ":" in unit):
            return
        known = self.assigned.units.setdefault(name, unit)
        if plain_unit(known) != plain_unit(unit):
            raise LayoutError(f"is in '{known}' by its name and in '{unit}' beside it", "mend the unit", name)

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
        if spelled not in PER_SECOND:
            raise LayoutError(f"is in '{unit}'", f"known: {', '.join(PER_SECOND)}", TIME)
        if self.units[column] and self.units[column] != spelled:
            raise LayoutError(
                f"is in {self.units[column]} by its name and in '{unit}' beside it",
                "name it time_s, time_ms, time_us or time_ns, or mend the unit",
                TIME,
            )
        self.units[column] = spelled
        self.per_second = PER_SECOND[spelled]

    def is_of_units(self, cells: Sequence[str]) -> bool:
        """Whether a line beside the names gives their units.

        Raises:
            LayoutError: it does for some channels, and for another something that is no unit.
        """
        if any(map(is_number, cells)):
            return False
        wanted = self.assigned.columns.sources if self.assigned is not None else {}
        beside = [(name, cell) for name, cell in zip(self.names, cells, strict=False) if plain_unit(cell)]
        known = [(name, cell) for name, cell in beside if name in CHANNELS or name in wanted]
        spelled = [name for name, cell in known if is_spelled(plain_unit(cell)) or is_spelled(cell)]
        stated = [name for name, source in wanted.items() if source.unit]
        strange = [one for one in known if one[0] not in (*spelled, *stated, TIME)]
        if spelled and strange:
            name, cell = strange[0]
            raise LayoutError(
                f"'{cell}' stands in a line of units and is none that is known",
                f"state it: {OPTION} '{name}=COLUMN, unit=…'",
                name,
            )
        return bool(spelled)

    def settle_decimal(self, rows: Sequence[Sequence[str]]) -> None:
        """Find out whether numbers have a decimal comma, from some rows.

        Raises:
            LayoutError: it cannot be known.
        """
        wanted = self.assigned.columns.sources if self.assigned is not None else {}
        columns = [column for column, name in enumerate(self.names) if name in CHANNELS or name in wanted]
        cells = [(row[c].strip(), self.names[c]) for row in rows for c in columns if c < len(row)]
        cells = [(cell, name) for cell, name in cells if not cell[:1].isalpha() and not is_stamp(cell)]
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


def plain_unit(unit: str) -> str:
    """A unit without brackets and blanks, in small letters."""
    plain = unit.strip().strip('"').strip("[]()").replace("·", "").replace("*", "").replace(" ", "").lower()
    return _SPELLINGS.get(plain, plain)


def is_number(cell: str) -> bool:
    """Whether a cell is a number of any country; the unit 1 is none."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return cell.strip() not in ("1",)  # a number without unit may have the unit 1


MOST_BETWEEN = 12  # lines between names and samples
UNITS_ABOVE = 6  # lines of a preamble that may give units
_TYPE = re.compile(r"[fiu][1248]|[ui]?int\d*|float\d*|double|single|real|bool", re.IGNORECASE)
#: What names the meaning of a line, in a column that is none: of ControlDesk, CANape, Yokogawa.
_LABELS = (
    "type",
    "path",
    "description",
    "name",
    "comment",
    "block",
    "raster",
    "device",
    "format",
    "datatype",
)


def first_sample(lines: Sequence[str], header: int, layout: Layout) -> int:
    """Number of the first line below the names in which a number stands."""
    for number, line in enumerate(lines[header + 1 : header + 2 + MOST_BETWEEN], header + 1):
        cells = [cell.strip() for cell in layout.cells(line)]
        if any(is_number(cell) or is_stamp(cell) for cell in cells) or set(cells) <= {"1"}:
            return number
    return header + 1


def take_units(lines: Sequence[str], header: int, samples: int, layout: Layout) -> None:
    """Units of a line below the names, or in a preamble above them; other lines below are noted.

    Raises:
        LayoutError: a line below the names may be one of units, and is not understood.
    """
    other = []
    units = None
    for number in (*range(header + 1, samples), *range(header - 1, max(-1, header - 1 - UNITS_ABOVE), -1)):
        cells = [cell.strip().strip('"') for cell in layout.cells(lines[number])]
        cells += [""] * (len(layout.names) - len(cells))
        if units is None and len(cells) >= len(layout.names) and _gives_units(cells, number, layout):
            units = number
            layout.take_units(cells[: len(layout.names)])
            layout.notes.append(f"line {number + 1} gives units")
        elif number > header and any(cells):
            _refuse_unless_known(cells, number, layout)
            other.append(number + 1)
    if other:
        which = f"line {other[0]}" if len(other) == 1 else f"{len(other)} lines from line {other[0]} on"
        layout.notes.append(f"{which} between names and samples: types or descriptions, left out")


def _gives_units(cells: Sequence[str], number: int, layout: Layout) -> bool:
    try:
        return layout.is_of_units(cells)
    except LayoutError as error:
        error.line = number
        raise


def _refuse_unless_known(cells: Sequence[str], number: int, layout: Layout) -> None:
    """Refuse a line of text below the names that is none of types or descriptions: it may be one of units."""
    sources = layout.assigned.columns.sources if layout.assigned is not None else {}
    if any(cell.lower() in _LABELS for cell in cells) or (sources and all(s.unit for s in sources.values())):
        return
    beside = zip(layout.names, cells, strict=False)
    strange = next((c for n, c in beside if n in CHANNELS and c and not _TYPE.fullmatch(c)), None)
    if strange is not None:
        error = LayoutError(
            f"'{strange}' stands below a name, and is no unit and no number",
            "if the line gives units, write units of the channels; with --columns, state unit= for each",
        )
        error.line = number
        raise error


def settle_rows(lines: Sequence[str], samples: int, layout: Layout) -> None:
    """Cells of a line, which may have fewer at the end than there are names; a time that is text."""
    cells = [cell.strip() for cell in layout.cells(lines[samples])]
    layout.cells_expected = len(layout.names)
    surplus = len(layout.names) - len(cells)
    if surplus > 0 and all(name in ("", "Comment") for name in layout.names[len(cells) :]):
        layout.names, layout.cells_expected = layout.names[: len(cells)], len(cells)
    time = layout.names.index(TIME) if TIME in layout.names else None
    if time is not None and time < len(cells) and is_stamp(cells[time]):
        layout.stamps = TimeStamps()
        layout.notes.append(f"'{TIME}' is a {kind_of(cells[time])}: it was counted from the first")
