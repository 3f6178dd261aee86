"""A block of whole lines of a text as columns of numbers: at once by Arrow, or cell by cell for messages."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.csv as arrow_csv

from hil.core.channels import TIME
from hil.core.recording._csv_layout import Layout
from hil.core.recording._table import Array

#: Spellings of a cell without a value; those with # are Excel's, or of Microsoft's C library.
_C_LIBRARY = ("IND", "IND00", "IND0000", "QNAN", "QNAN0", "QNAN00", "INF", "INF00", "INF0000", "SNAN")
MISSING = frozenset(
    (
        *("", "NA", "N/A", "n/a", "n.a.", "NaN", "nan", "-NaN", "-nan", "NULL", "null", "None", "<NA>"),
        *("#N/A", "#NA", "#NV", "#DIV/0!", "#VALUE!", "#WERT!", "-", "--", "---", "NoValue"),
        *(f"{sign}1{point}#{kind}" for sign in ("", "-") for point in ".," for kind in _C_LIBRARY),
    )
)


def columns_at_once(
    block: bytes, layout: Layout, wanted: Collection[int], lines: int
) -> dict[int, Array] | None:
    """Columns of a block by their numbers; None if anything in it needs a closer look."""
    before = replace(layout.stamps) if layout.stamps is not None else None
    read = _at_once(block, layout, wanted, lines)
    if read is None:
        layout.stamps = before  # as if the block had not been looked at
    return read


def _at_once(block: bytes, layout: Layout, wanted: Collection[int], lines: int) -> dict[int, Array] | None:
    names = [str(column) for column in wanted]
    time = str(layout.names.index(TIME)) if layout.stamps is not None else ""
    try:
        table = arrow_csv.read_csv(
            pa.BufferReader(block),
            read_options=arrow_csv.ReadOptions(
                column_names=[str(column) for column in range(layout.cells_expected)],
                use_threads=False,
                block_size=len(block) + 1,
            ),
            parse_options=arrow_csv.ParseOptions(delimiter=layout.separator),
            convert_options=arrow_csv.ConvertOptions(
                include_columns=names,
                column_types={name: pa.string() if name == time else pa.float64() for name in names},
                null_values=sorted(MISSING),
                strings_can_be_null=True,
                decimal_point=layout.decimal,
            ),
        )
    except pa.ArrowInvalid:
        return None
    if len(table) != lines:
        return None  # blank lines, or a quoted cell that goes over the end of its line
    read = {}
    for column in wanted:
        cells = table.column(str(column))
        if str(column) == time and layout.stamps is not None:
            try:
                read[column] = layout.stamps.seconds(cells.combine_chunks())
            except ValueError:
                return None
        else:
            read[column] = np.asarray(cells.to_numpy(), np.float64)
    return None if any(np.isinf(values).any() for values in read.values()) else read


def number_in(cell: str, layout: Layout, column: int) -> float:
    """A cell's value, NaN if it is missing.

    Raises:
        ValueError: it is no number.
    """
    if cell in MISSING:
        return math.nan
    if layout.stamps is not None and layout.names[column] == TIME:
        return float(layout.stamps.seconds(pa.array([cell], pa.string()))[0])
    if "_" in cell or not cell.isascii():
        raise ValueError  # Python's own spellings
    if layout.decimal == ".":
        return float(cell)
    if "." in cell:
        raise ValueError  # after commas a point separates thousands, or somebody mixed files
    return float(cell.replace(",", "."))


def about_signs(cell: str) -> str:
    """What to do about a cell that is a number of another country."""
    strange = cell.replace(",", "").replace(".", "").lstrip("+-").isdigit()
    return "write numbers with one decimal sign and without thousands separators" if strange else ""
