"""What stands between the names of a table of text and its samples: units, types, descriptions."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hil.core.channels import CHANNELS, TIME
from hil.core.recording._csv_layout import Layout, LayoutError, is_number
from hil.core.recording._time_stamps import TimeStamps, is_stamp, kind_of

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
