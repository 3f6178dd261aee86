"""Reads CSV block by block: the text is never held whole, and a message names line and column."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.csv as arrow_csv

from hil.core.channels import CHANNELS, TIME
from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.recording._csv_encoding import as_utf8
from hil.core.recording._csv_layout import Layout, LayoutError, layout_of, names_separator
from hil.core.recording._csv_writer import sha256_of
from hil.core.recording._evidence import LARGEST_BYTES, sidecar, take_evidence
from hil.core.recording._table import Array, Recording, refuse_too_large

T = TypeVar("T")

_BLOCK_BYTES = 8 << 20
_LONGEST_LINE_BYTES = 1 << 20
_BOM = b"\xef\xbb\xbf"
_NEVER_IN_TEXT = frozenset(range(9)) | frozenset(range(14, 32))
_SOME_BYTES = 200_000  # of rows that show the decimal sign
_FEW_SAMPLES = 10
_SLOW_S, _TOO_SLOW_S = 0.05, 0.5  # between samples: no command needs less than 100 Hz
#: Spellings of a cell without a value.
_MISSING = frozenset(
    ("", "NA", "N/A", "n/a", "NaN", "nan", "-NaN", "-nan", "NULL", "null", "None", "<NA>", "#N/A", "#NA")
)


def read_csv(path: Path) -> Recording:
    """Read a CSV with one header line; messages name file, line and column.

    Raises:
        BadInputError: no regular text file, empty, no header line, a line with too few or too many cells, a
            cell of a known channel that is no number, or a layout that can be read in two ways.
    """
    with open_regular(path) as file:
        try:
            recording = _Table(path).read(as_utf8(file))
        except UnicodeError as error:
            raise BadInputError("is not valid UTF-16", where=str(path)) from error
        except OSError as error:
            raise BadInputError(f"cannot be read: {error.strerror or error}", where=str(path)) from error
    _take_sidecar(recording, path)
    return recording


def _take_sidecar(recording: Recording, path: Path) -> None:
    """What an export wrote beside the table."""
    beside = sidecar(path)
    try:
        if not beside.is_file():
            return
        if beside.stat().st_size > LARGEST_BYTES:
            recording.damage.append(f"{beside.name} has more than {LARGEST_BYTES} bytes and was not read")
            return
        take_evidence(recording, beside.read_bytes(), beside.name, sha256_of(path))
    except OSError as error:
        recording.damage.append(f"{beside.name} cannot be read: {error.strerror or error}")


class _Table:
    """A table that grows by blocks of whole lines."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._header: list[str] = []
        self._layout = Layout([])
        self._columns: dict[int, list[Array]] = {}
        self._notes: list[str] = []
        self._blank_lines: list[int] = []
        self._line = 1
        self._samples = 0

    def read(self, file: BinaryIO) -> Recording:
        for block in self._blocks(file):
            self._take(block)
        if not self._header:
            raise BadInputError(
                "the file is empty",
                where=f"{self._path}: line 1",
                fix="a recording has a header line and a line for each sample",
            )
        channels = {}
        for column in list(self._columns):
            values = np.concatenate([*self._columns.pop(column), np.zeros(0)])
            conversion = self._layout.conversions.get(column)
            channels[self._header[column]] = values if conversion is None else conversion.of(values)
        self._settle_time(channels)
        return Recording(channels, self._path, notes=self._notes, blank_lines=self._blank_lines)

    def _blocks(self, file: BinaryIO) -> Iterator[bytes]:
        """Whole lines, each ended by a line feed."""
        rest = b""
        while data := file.read(_BLOCK_BYTES):
            data = rest + data
            end = data.rfind(b"\n") + 1 or data.rfind(b"\r", 0, len(data) - 1) + 1
            if len(data) - end > _LONGEST_LINE_BYTES:  # else a file without line ends is held whole
                first = _line_feeds(data[:end]).count(b"\n")
                raise self._error(f"is longer than {_LONGEST_LINE_BYTES} bytes", self._line + first)
            rest = data[end:]
            if end:
                yield _line_feeds(data[:end])
        if rest:
            yield _line_feeds(rest + b"\n")

    def _take(self, block: bytes) -> None:
        if not block.isascii():
            block = self._in_utf8(block)
        if not self._header:
            header, _, block = block.removeprefix(_BOM).partition(b"\n")
            if names_separator(header):
                header, _, block = block.partition(b"\n")
                self._blank_lines.append(0)
                self._line += 1
            self._take_header(header)
            block = self._without_units(block)
            self._settle_decimal(block)
        if not block:
            return
        lines = block.count(b"\n")
        read = self._fast(block, lines) or self._careful(block)
        for column, values in read.items():
            self._columns[column].append(values)
        self._samples += len(next(iter(read.values())))
        refuse_too_large(self._samples, len(self._columns), str(self._path))
        self._line += lines

    def _in_utf8(self, block: bytes) -> bytes:
        try:
            block.decode("utf-8")
        except UnicodeDecodeError as error:
            if set(block) & _NEVER_IN_TEXT:
                line = self._line + block.count(b"\n", 0, error.start)
                raise self._error("not a text file", line) from error
            note = "text is not UTF-8 and was read as Latin-1"
            self._notes += [note] if note not in self._notes else []
            return block.decode("latin-1").encode()
        return block

    def _take_header(self, line: bytes) -> None:
        self._layout = self._unless_in_doubt(lambda: layout_of(line.decode()), self._line)
        header = self._header = self._layout.names
        refuse_too_large(0, len(header), str(self._path))
        self._columns = {column: [] for column, name in enumerate(header) if name}
        self._notes += [f"column {c + 1} has no name and was left out" for c, n in enumerate(header) if not n]
        self._line += 1

    def _without_units(self, block: bytes) -> bytes:
        """The block without a line of units, where it begins with one."""
        line, _, rest = block.partition(b"\n")
        cells = [cell.strip() for cell in self._layout.cells(line.decode())]
        if len(cells) != len(self._header) or not self._layout.is_of_units(cells):
            return block
        self._unless_in_doubt(lambda: self._layout.take_units(cells), self._line)
        self._layout.notes.append(f"line {self._line} gives units")
        self._blank_lines.append(0)
        self._line += 1
        return rest

    def _settle_decimal(self, block: bytes) -> None:
        some = block[:_SOME_BYTES].decode(errors="ignore").split("\n")[:-1]
        rows = [self._layout.cells(line) for line in some]
        self._unless_in_doubt(lambda: self._layout.settle_decimal(rows), self._line)
        self._notes += self._layout.notes

    def _unless_in_doubt(self, look: Callable[[], T], line: int) -> T:
        try:
            return look()
        except LayoutError as error:
            raise self._error(error.what, line, error.column, error.fix) from error

    def _settle_time(self, channels: dict[str, Array]) -> None:
        """Time in seconds; without a unit it may be milliseconds under the name of seconds."""
        time = channels.get(TIME, np.zeros(0))
        if self._layout.per_second != 1.0:
            channels[TIME] = time / self._layout.per_second
        apart_s = float(np.median(np.diff(channels[TIME]))) if len(time) > _FEW_SAMPLES else 0.0
        if apart_s >= _TOO_SLOW_S:
            raise self._error(
                f"samples are {apart_s:g} s apart",
                self._line - 1,
                TIME,
                fix="if it is in milliseconds, name the column time_ms (or time_us) to have it converted",
            )
        if apart_s >= _SLOW_S:
            self._notes.append(f"samples are {apart_s:g} s apart; a column in ms is to be named time_ms")

    def _fast(self, block: bytes, lines: int) -> dict[int, Array] | None:
        """The block's columns; None if anything in it needs a closer look."""
        names = [str(column) for column in self._columns]
        try:
            table = arrow_csv.read_csv(
                pa.BufferReader(block),
                read_options=arrow_csv.ReadOptions(
                    column_names=[str(column) for column in range(len(self._header))],
                    use_threads=False,
                    block_size=len(block) + 1,
                ),
                parse_options=arrow_csv.ParseOptions(delimiter=self._layout.separator),
                convert_options=arrow_csv.ConvertOptions(
                    include_columns=names,
                    column_types=dict.fromkeys(names, pa.float64()),
                    null_values=sorted(_MISSING),
                    decimal_point=self._layout.decimal,
                ),
            )
        except pa.ArrowInvalid:
            return None
        if len(table) != lines:
            return None  # blank lines, or a quoted cell that goes over the end of its line
        read = {c: np.asarray(table.column(str(c)).to_numpy(), np.float64) for c in self._columns}
        return None if any(np.isinf(values).any() for values in read.values()) else read

    def _careful(self, block: bytes) -> dict[int, Array]:
        """The block's columns, cell by cell; BadInputError names the first that cannot be read."""
        read: dict[int, list[float]] = {column: [] for column in self._columns}
        samples = self._samples
        for line, text in enumerate(block.decode().split("\n")[:-1], self._line):
            if not text.strip():
                self._blank_lines.append(samples)
                continue
            cells = self._layout.cells(text)
            if len(cells) != len(self._header):
                raise self._wrong_number_of_cells(cells, line)
            for column in list(read):
                value = self._number(cells[column].strip(), column, line)
                if value is None:
                    self._leave_out(column)
                    del read[column]
                else:
                    read[column].append(value)
            samples += 1
        return {column: np.array(values, np.float64) for column, values in read.items()}

    def _number(self, cell: str, column: int, line: int) -> float | None:
        """The cell's value, NaN if it is missing, None if it is text in a column that no one needs."""
        if cell in _MISSING:
            return math.nan
        name = self._header[column]
        try:
            if "_" in cell or not cell.isascii():
                raise ValueError  # Python's own spellings
            value = float(self._with_point(cell))
        except ValueError:
            if name not in CHANNELS:
                return None
            raise self._error(f"{_short(cell)} is not a number", line, name, _about_signs(cell)) from None
        if math.isinf(value) and "inf" not in cell.lower() and name in CHANNELS:
            raise self._error(f"{_short(cell)} is beyond what a number can hold", line, name)
        return value

    def _with_point(self, cell: str) -> str:
        if self._layout.decimal == ".":
            return cell
        if "." in cell:
            raise ValueError  # after commas a point separates thousands, or somebody mixed files
        return cell.replace(",", ".")

    def _wrong_number_of_cells(self, cells: list[str], line: int) -> BadInputError:
        names = len(self._header)
        many = self._layout.separator == "," and len(cells) > names
        fix = "if the comma is the decimal sign, separate columns by semicolons" if many else ""
        return self._error(f"has {len(cells)} cells, the header line names {names}", line, fix=fix)

    def _leave_out(self, column: int) -> None:
        del self._columns[column]
        self._notes.append(f"column '{self._header[column]}' is not numeric and was left out")

    def _error(self, what: str, line: int, column: str = "", fix: str = "") -> BadInputError:
        place = f"{self._path}: line {line}"
        return BadInputError(what, where=f"{place}, column '{column}'" if column else place, fix=fix)


def _line_feeds(block: bytes) -> bytes:
    if b"\r" not in block:
        return block
    return block.replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def _about_signs(cell: str) -> str:
    """What to do about a cell that is a number of another country."""
    strange = cell.replace(",", "").replace(".", "").lstrip("+-").isdigit()
    return "write numbers with one decimal sign and without thousands separators" if strange else ""


def _short(cell: str) -> str:
    return repr(cell) if len(cell) <= 40 else f"{cell[:40]!r}…"
