"""Where in the text of another tool the table begins: preamble, names, units, types, and the first sample."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from hil.core.channels import CHANNELS, TIME
from hil.core.errors.wording import repeated
from hil.core.recording._assigned import assigned, is_there, listing
from hil.core.recording._column_map import OPTION, ColumnMap
from hil.core.recording._csv_layout import (
    MOST_BETWEEN,
    PER_SECOND,
    UNITS_ABOVE,
    Layout,
    LayoutError,
    first_sample,
    is_number,
    plain_unit,
    settle_rows,
    take_units,
)
from hil.core.recording._time_stamps import is_stamp

#: Lines and characters of a file among which its names are looked for.
MOST_LINES, MOST_CHARACTERS = 400, 1 << 20
_SEPARATORS = {",": "comma", ";": "semicolon", "\t": "tab", "|": "bar"}
_NAMED_WITH_UNIT = re.compile(r"(.+?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]")
_TIME_NAMES = ("time", "t", "timestamp", "timestamps")
#: Names that other tools give to time: the first of LabVIEW, the second of ControlDesk.
_FURTHER_TIME_NAMES = ("x_value", "xaxis", "zeit", "uhrzeit", "rectime", "recording time", "time of day")
_IN_SECONDS = ("x_value", "xaxis")
_SEPARATOR_LINE = re.compile(rb"\"?sep=(.|\t)\"?", re.IGNORECASE)
_DISTANCE = re.compile(r"^\s*\"?Delta_X\"?[\t,;]\s*\"?([-+0-9.,eE]+)", re.MULTILINE)


@dataclass
class TableBegin:
    """The layout, and the numbers of the lines (from 0) with names and with the first sample."""

    layout: Layout
    names: int
    samples: int


def names_separator(line: bytes) -> bool:
    """Whether a first line is no header, but tells Excel the separator: `sep=;`."""
    return _SEPARATOR_LINE.fullmatch(line.strip()) is not None


def table_begin(lines: Sequence[str], columns: ColumnMap, where: str) -> TableBegin:
    """Find names and samples in the first lines of a file.

    Raises:
        LayoutError: no line names a time, or two names are one.
        BadInputError: a column of the map is not there.
    """
    lines = _bounded(lines)
    first = 1 if lines and names_separator(lines[0].encode()) else 0
    header, doubt = first, None
    layout = None
    if not columns and first < len(lines):
        try:
            layout = _layout_of_names(lines[first])
        except LayoutError as error:
            doubt = error
    if layout is None:
        found = _named_line(lines, columns)
        if found is None:
            nothing = doubt or _nothing_found(lines, columns)
            nothing.line = first
            raise nothing
        header, separator = found
        layout = _layout(lines, header, separator, columns, where, doubt)
        if header > first:
            layout.notes.insert(0, f"{_lines(header - first)} above the names, left out")
    samples = first_sample(lines, header, layout)
    take_units(lines, header, samples, layout)
    if samples < len(lines):
        settle_rows(lines, samples, layout)
    return TableBegin(layout, header, samples)


def _lines(count: int) -> str:
    return "1 line stands" if count == 1 else f"{count} lines stand"


def counted_distance_s(lines: Sequence[str]) -> float:
    """Distance of samples in s that the preamble of a LabVIEW file states; 0 if it does not."""
    found = _DISTANCE.search("\n".join(_bounded(lines)))
    try:
        return float(found[1].replace(",", ".")) if found else 0.0
    except ValueError:
        return 0.0


def _bounded(lines: Sequence[str]) -> list[str]:
    """As many of the first lines as are looked at, the first one always."""
    kept: list[str] = []
    count = 0
    for line in lines[:MOST_LINES]:
        count += len(line)
        if kept and count > MOST_CHARACTERS:
            break
        kept.append(line)
    return kept


def _nothing_found(lines: Sequence[str], columns: ColumnMap) -> LayoutError:
    wanted = ", ".join(f"'{source.column}'" for _, source in columns.columns())
    seen = next((cells for line in lines if len(cells := _split(line)[0]) > 1), [])
    return LayoutError(
        f"no line names the columns {wanted}", f"the first line with several cells has: {listing(seen)}"
    )


def _split(line: str) -> tuple[list[str], str]:
    """Cells of a line by the separator that makes the most of them."""
    counts = {separator: line.count(separator) for separator in _SEPARATORS}
    separator = max(counts, key=lambda one: counts[one])
    return [cell.strip() for cell in Layout([], separator).cells(line)], separator


def _layout_of_names(header: str) -> Layout:
    """The layout that a header line with the names of channels shows.

    Raises:
        LayoutError: it names no time, or two of its names are one.
    """
    seen: list[str] = []
    for separator in _SEPARATORS:
        cells = [cell.strip() for cell in Layout([], separator).cells(header)]
        seen = cells if len(cells) > len(seen) else seen
        if any(name == TIME for name, _, _ in map(_name_and_unit, cells)):
            return _with_names(cells, separator)
        if any(cell.lower() in _TIME_NAMES for cell in cells):
            time = next(cell for cell in cells if cell.lower() in _TIME_NAMES)
            raise LayoutError(
                f"the header line has no '{TIME}', and its '{time}' has no unit",
                f"name it time_s, time_ms, time_us or time_ns; or {OPTION} '{TIME}={time}, unit=ms'",
            )
    raise LayoutError(
        f"the header line has no '{TIME}'",
        f"the first line names the channels; columns of other names: {OPTION} '{TIME}=COLUMN, unit=ms'; "
        f"it has: {listing(seen)}",
    )


def _with_names(cells: list[str], separator: str) -> Layout:
    found = Layout([], separator)
    named = [_name_and_unit(cell) for cell in cells]
    found.names = [name for name, _, _ in named]
    found.units = [unit if name == TIME else "" for name, unit, _ in named]
    duplicate = repeated(name for name in found.names if name)
    if duplicate:
        raise LayoutError(f"column '{duplicate[0]}' stands twice", "leave one of them out")
    time = found.names.index(TIME)
    if found.units[time]:
        found.per_second = PER_SECOND[found.units[time]]
    found.take_units([beside for _, _, beside in named])
    if found.per_second != 1.0:
        found.notes.append(f"'{cells[time]}' was converted from {found.units[time]} to s")
    other = next((c for c, n in zip(cells, found.names, strict=True) if n == c.lower() != c), None)
    if other is not None:
        found.notes.append(f"'{other}' was read as '{other.lower()}', others likewise")
    _note_separator(found)
    return found


def _note_separator(layout: Layout) -> None:
    if layout.separator != ",":
        layout.notes.insert(0, f"columns are separated by {_SEPARATORS[layout.separator]}s")


def _name_and_unit(cell: str) -> tuple[str, str, str]:
    """A column's name, the unit of time that its name says, and the unit that stands beside it."""
    whole = _NAMED_WITH_UNIT.fullmatch(cell)
    name, beside = (whole[1], whole[2]) if whole else (cell, "")
    if name.lower() in _TIME_NAMES and plain_unit(beside) in PER_SECOND:
        return TIME, "", beside
    head, _, unit = name.rpartition("_")
    if head.lower() == "time" and plain_unit(unit) in PER_SECOND:
        return TIME, plain_unit(unit), beside
    # what is no channel keeps its name as it is
    return (name.lower(), "", beside) if name.lower() in CHANNELS else (cell, "", "")


def _is_time(cell: str) -> bool:
    name, _, _ = _name_and_unit(cell)
    return name == TIME or cell.lower() in (*_TIME_NAMES, *_FURTHER_TIME_NAMES)


def _named_line(lines: Sequence[str], columns: ColumnMap) -> tuple[int, str] | None:
    """The line that names the most of the columns that are wanted, and its separator."""
    best: tuple[int, int, str] | None = None
    wanted = [source.column for _, source in columns.columns()]
    words = [re.split(r"[^\w]", column.lower())[-1] or column.lower() for column in wanted]
    for number, line in enumerate(lines):
        lower = line.lower()
        if wanted and not any(word in lower for word in words):
            continue
        for separator in _SEPARATORS:
            if separator not in line:
                continue
            cells = [cell.strip() for cell in Layout([], separator).cells(line)]
            score = _score(cells, wanted, counted=columns.every_s > 0)
            if score > (best[0] if best else 0) and _has_samples(lines, number, separator, len(cells)):
                best = score, number, separator
    return (best[1], best[2]) if best else None


def _score(cells: list[str], wanted: list[str], *, counted: bool) -> int:
    times = sum(map(_is_time, cells))
    if wanted:
        found = sum(is_there(column, cells) + (column in cells) for column in wanted)
        return found + (times > 0) if found else 0
    channels = sum(_name_and_unit(cell)[0] in CHANNELS for cell in cells)
    return times + channels if times or counted else 0


def _has_samples(lines: Sequence[str], header: int, separator: str, cells: int) -> bool:
    """Whether some lines below one there are numbers, about as many as it has cells."""
    for line in lines[header + 1 : header + 2 + MOST_BETWEEN]:
        found = [cell.strip() for cell in Layout([], separator).cells(line)]
        numbers = sum(is_number(cell) or is_stamp(cell) or cell == "1" for cell in found)
        if numbers and abs(len(found) - cells) <= 1 and len(found) > 1:
            return True
    return False


def _layout(
    lines: Sequence[str],
    header: int,
    separator: str,
    columns: ColumnMap,
    where: str,
    doubt: LayoutError | None,
) -> Layout:
    """The layout below a line of names of another tool."""
    cells = [cell.strip() for cell in Layout([], separator).cells(lines[header])]
    if columns:
        own = [_name_and_unit(cell)[0] if not _is_mapped(cell, columns) else cell for cell in cells]
        names = [
            cell if name == TIME and TIME in columns.sources else name
            for cell, name in zip(cells, own, strict=True)
        ]
        found = Layout([], separator, assigned=assigned(names, columns, f"{where}: line {header + 1}"))
        assert found.assigned is not None
        found.names = found.assigned.channels
        found.units = [""] * len(cells)
        named = [_name_and_unit(cell) for cell in cells]
        found.take_units([unit or beside for _, unit, beside in named])
        if TIME not in found.names and not columns.every_s:
            _name_time(lines, header, cells, found, doubt)
        _drop_repeated(found)
        _note_separator(found)
        return found
    if any(name == TIME for name, _, _ in map(_name_and_unit, cells)):
        return _with_names(cells, separator)
    found = Layout([_name_and_unit(cell)[0] for cell in cells], separator, units=[""] * len(cells))
    _name_time(lines, header, cells, found, doubt)
    found.take_units([_name_and_unit(cell)[2] for cell in cells])
    _drop_repeated(found)
    _note_separator(found)
    return found


def _is_mapped(cell: str, columns: ColumnMap) -> bool:
    return any(is_there(source.column, [cell]) for _, source in columns.columns())


def _name_time(
    lines: Sequence[str], header: int, cells: list[str], found: Layout, doubt: LayoutError | None
) -> None:
    """Take the column that other tools call time for it, if its unit is beyond doubt.

    Raises:
        LayoutError: it is not.
    """
    number = next((n for n, cell in enumerate(cells) if _is_time(cell)), None)
    if number is None:
        raise doubt or LayoutError(
            f"no column is '{TIME}'", f"{OPTION} '{TIME}=COLUMN, unit=s'; it has: {listing(cells)}"
        )
    found.names[number] = TIME
    below = [
        Layout([], found.separator).cells(line) for line in lines[header + 1 : header + 2 + MOST_BETWEEN]
    ]
    above = [Layout([], found.separator).cells(line) for line in lines[max(0, header - UNITS_ABOVE) : header]]
    beside = [row[number] for row in (*below, *above) if len(row) > number]
    stamped = any(is_stamp(cell) for cell in beside)
    in_a_row = any(plain_unit(cell) in PER_SECOND for cell in beside)
    name, _, unit = _name_and_unit(cells[number])
    if name == TIME or stamped or in_a_row or unit:
        if cells[number].lower() == "time":
            return
        found.notes.append(f"'{cells[number]}' was taken to be the time")
    elif cells[number].lower() in _IN_SECONDS:
        found.notes.append(f"'{cells[number]}' was taken to be the time, in s as its tool writes it")
    else:
        raise doubt or LayoutError(
            f"'{cells[number]}' has no unit", f"{OPTION} '{TIME}={cells[number]}, unit=s'", cells[number]
        )


def _drop_repeated(found: Layout) -> None:
    """Raises:
    LayoutError: a channel stands twice. Of other columns the first is taken.
    """
    seen: set[str] = set()
    wanted = found.assigned.columns.sources if found.assigned is not None else {}
    for number, name in enumerate(found.names):
        if name in seen and (name in CHANNELS or name in wanted):
            raise LayoutError(f"column '{name}' stands twice", "leave one of them out")
        if name in seen:
            found.notes.append(f"column '{name}' stands twice; the first was taken")
            found.names[number] = ""
        seen.add(name or "")
