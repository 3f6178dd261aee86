"""Tables of text block by block by Arrow: lines to columns of numbers, and columns to lines.

Cells are parsed one by one only for messages. What is written has nine significant digits.
"""

from __future__ import annotations

import csv
import hashlib
import io
import math
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as compute
import pyarrow.csv as arrow_csv

from hil.core.channels import TIME
from hil.core.files import replacing, write_atomically
from hil.core.recording._csv_layout import Layout
from hil.core.recording._evidence import evidence_of, has_evidence, remove_sidecar, sidecar
from hil.core.recording._table import Array, Recording

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


_ROWS_AT_ONCE = 1 << 16
_DIGITS = 9
_POWERS = np.array([float(f"1e{power}") for power in range(23)])  # these are exact doubles
_LARGEST_EXACT_TIME_S = 9e6  # in whole nanoseconds still an exact double


def write_csv(recording: Recording, path: Path) -> None:
    """Write every channel with 9 significant digits, `time_s` in whole nanoseconds.

    A number always has a decimal point (1.0, not 1); a missing one is an empty cell. What the recording has
    beside its samples stands in a file next to it (`sidecar`).
    """
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(recording.channels)
    options = arrow_csv.WriteOptions(include_header=False, quoting_style="none")
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(header.getvalue().encode())
        for _, rows in recording.blocks(at_once=_ROWS_AT_ONCE):
            block = {name: _as_text(values, is_time=name == TIME) for name, values in rows.items()}
            arrow_csv.write_csv(pa.table(block), file, options)
        file.close()
        if has_evidence(recording):
            write_atomically(sidecar(path), evidence_of(recording, sha256_of(temporary)))
        else:
            remove_sidecar(path)


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _as_text(values: Array, *, is_time: bool) -> pa.Array:
    rounded = _whole_nanoseconds(values) if is_time else _nine_digits(values)
    shortest = compute.cast(pa.array(rounded, from_pandas=True), pa.string())  # NaN: an empty cell
    return compute.replace_substring_regex(shortest, r"^(-?\d+)(e.*)?$", r"\1.0\2")


def _whole_nanoseconds(time_s: Array) -> Array:
    exact = np.abs(time_s) < _LARGEST_EXACT_TIME_S
    return np.where(exact, np.rint(np.where(exact, time_s, 0.0) * 1e9) / 1e9, time_s)


def _nine_digits(values: Array) -> Array:
    """The doubles nearest to the values' decimals of nine significant digits."""
    rounded = np.array(values, np.float64)
    usual = (np.abs(rounded) > 1e-13) & (np.abs(rounded) < 1e29)
    some = rounded[usual]
    power = _DIGITS - 1 - np.floor(np.log10(np.abs(some))).astype(np.intp)
    scale = _POWERS[np.abs(power)]
    # the quotient and the product of two exact doubles are the doubles nearest to the decimal
    rounded[usual] = np.where(power >= 0, np.rint(some * scale) / scale, np.rint(some / scale) * scale)
    for index in np.flatnonzero(~usual & np.isfinite(rounded) & (rounded != 0)):
        rounded[index] = float(f"{rounded[index]:.{_DIGITS}g}")
    return rounded
