"""Reads CSV block by block: the text is never held whole, and a message names line and column."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pyarrow as pa
import pyarrow.csv as arrow_csv

from hil.core.channels import CHANNELS, TIME
from hil.core.errors import BadInputError
from hil.core.recording._csv_writer import sha256_of
from hil.core.recording._evidence import LARGEST_BYTES, sidecar, take_evidence
from hil.core.recording._regular_file import open_regular
from hil.core.recording._table import Array, Recording

_BLOCK_BYTES = 8 << 20
_LONGEST_LINE_BYTES = 1 << 20
_BOM = b"\xef\xbb\xbf"
#: Spellings of a cell without a value.
_MISSING = frozenset(
    ("", "NA", "N/A", "n/a", "NaN", "nan", "-NaN", "-nan", "NULL", "null", "None", "<NA>", "#N/A", "#NA")
)


def read_csv(path: Path) -> Recording:
    """Read a CSV with one header line; messages name file, line and column.

    Raises:
        BadInputError: no regular UTF-8 file, no header line, a line with too few or too many cells, or a
            cell of a known channel that is no number.
    """
    with open_regular(path) as file:
        try:
            recording = _Table(path).read(file)
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
        self._columns: dict[int, list[Array]] = {}
        self._notes: list[str] = []
        self._blank_lines: list[int] = []
        self._line = 1
        self._samples = 0

    def read(self, file: BinaryIO) -> Recording:
        for block in self._blocks(file):
            self._take(block)
        if not self._header:
            self._take_header(b"")
        channels = {}
        for column in list(self._columns):
            channels[self._header[column]] = np.concatenate([*self._columns.pop(column), np.zeros(0)])
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
            try:
                block.decode("utf-8")
            except UnicodeDecodeError as error:
                line = self._line + block.count(b"\n", 0, error.start)
                raise self._error("not a UTF-8 text file", line) from error
        if not self._header:
            header, _, block = block.removeprefix(_BOM).partition(b"\n")
            self._take_header(header)
        if not block:
            return
        lines = block.count(b"\n")
        read = self._fast(block, lines) or self._careful(block)
        for column, values in read.items():
            self._columns[column].append(values)
        self._samples += len(next(iter(read.values())))
        self._line += lines

    def _take_header(self, line: bytes) -> None:
        header = [cell.strip() for cell in _cells(line.decode())]
        if TIME not in header:
            raise self._error(f"the header line has no '{TIME}'", 1, fix="the first line names the channels")
        duplicate = sorted({name for name in header if name and header.count(name) > 1})
        if duplicate:
            raise self._error(f"column '{duplicate[0]}' stands twice", 1)
        self._header = header
        self._columns = {column: [] for column, name in enumerate(header) if name}
        self._notes += [f"column {c + 1} has no name and was left out" for c, n in enumerate(header) if not n]
        self._line = 2

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
                convert_options=arrow_csv.ConvertOptions(
                    include_columns=names,
                    column_types=dict.fromkeys(names, pa.float64()),
                    null_values=sorted(_MISSING),
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
            cells = _cells(text)
            if len(cells) != len(self._header):
                raise self._error(f"has {len(cells)} cells, the header line names {len(self._header)}", line)
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
        """The cell's value, NaN if it is missing, None if it is text in a column that nobody needs."""
        if cell in _MISSING:
            return math.nan
        name = self._header[column]
        try:
            value = float(cell)
            if "_" in cell or not cell.isascii():
                raise ValueError  # Python's own spellings
        except ValueError:
            if name not in CHANNELS:
                return None
            raise self._error(f"{_short(cell)} is not a number", line, name) from None
        if math.isinf(value) and "inf" not in cell.lower() and name in CHANNELS:
            raise self._error(f"{_short(cell)} is beyond what a number can hold", line, name)
        return value

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


def _cells(line: str) -> list[str]:
    if '"' not in line:
        return line.split(",")
    return next(csv.reader([line], skipinitialspace=True), [])


def _short(cell: str) -> str:
    return repr(cell) if len(cell) <= 40 else f"{cell[:40]!r}…"
