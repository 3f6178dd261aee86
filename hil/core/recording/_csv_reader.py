"""Reads tables of text block by block: the text is never held whole, and a message names line and column."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO, TypeVar

import numpy as np

from hil.core.channels import CHANNELS, TIME
from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._csv_block import about_signs, columns_at_once, number_in, sha256_of
from hil.core.recording._csv_header import MOST_LINES, counted_distance_s, table_begin
from hil.core.recording._csv_layout import Layout, LayoutError, as_utf8
from hil.core.recording._evidence import LARGEST_BYTES, sidecar, take_evidence
from hil.core.recording._foreign_table import settled
from hil.core.recording._table import Array, Recording, refuse_too_large
from hil.core.recording._table_clock import counted_on, refuse_sentinel

T = TypeVar("T")

_BLOCK_BYTES = 8 << 20
_LONGEST_LINE_BYTES = 1 << 20
_BOM = b"\xef\xbb\xbf"
_NEVER_IN_TEXT = frozenset(range(9)) | frozenset(range(14, 32))
_SOME_BYTES = 200_000  # of rows that show the decimal sign
_FEW_SAMPLES = 10
_SLOW_S, _TOO_SLOW_S = 0.05, 0.5  # between samples: no command needs less than 100 Hz
_MOST_BELOW = 100  # lines below the samples that are none


def read_csv(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """Read a table of text; messages name file, line and column.

    Above the names a preamble may stand, below them lines of units and types, below the samples a footer.

    Raises:
        BadInputError: no regular text file, empty, no header line, a line with too few or too many cells, a
            cell of a known channel that is no number, or a layout that can be read in two ways.
    """
    with open_regular(path) as file:
        try:
            recording = _Table(path, columns).read(as_utf8(file))
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

    def __init__(self, path: Path, columns: ColumnMap) -> None:
        self._path, self._map = path, columns
        self._header: list[str] = []
        self._layout = Layout([])
        self._columns: dict[int, list[Array]] = {}
        self._notes: list[str] = []
        self._blank_lines: list[int] = []
        self._line = 1
        self._samples = 0
        self._below: list[
            BadInputError
        ] = []  # lines that are samples of no kind: the file should end with them
        self._distance_s = 0.0

    def read(self, file: BinaryIO) -> Recording:
        for block in self._blocks(file):
            self._take(block)
        if not self._header:
            raise BadInputError(
                "the file is empty",
                where=f"{self._path}: line 1",
                fix="a recording has a header line and a line for each sample",
            )
        if self._below:
            lines = "1 line" if len(self._below) == 1 else f"{len(self._below)} lines"
            self._notes.append(f"{lines} at the end of the file: no samples, left out")
        return self._recording()

    def _recording(self) -> Recording:
        assigned = self._layout.assigned
        own = sidecar(self._path).is_file()
        channels = {}
        for column in list(self._columns):
            values = np.concatenate([*self._columns.pop(column), np.zeros(0)])
            name = self._header[column]
            if assigned is not None:
                numbers = name == TIME and self._layout.stamps is None
                values = counted_on(values, self._notes) if numbers else values
                where = f"{self._path}: column '{name}'"
                stamps = name == TIME and not numbers
                channels[name] = values if stamps else assigned.convert(values, name, "", where)
                continue
            if name in CHANNELS and name != TIME and not own:
                refuse_sentinel(values, name, f"{self._path}: column '{name}'")
            conversion = self._layout.conversions.get(column)
            channels[name] = values if conversion is None else conversion.of(values)
        self._settle_time(channels)
        if self._layout.stamps is not None:
            self._notes += self._layout.stamps.notes
        blank = self._blank_lines
        found = settled(channels, self._path, assigned, self._notes, own=own)
        found.blank_lines = blank if found.samples == self._samples else []
        return found

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
            block = self._take_header(block.removeprefix(_BOM))
            self._settle_decimal(block)
        if not block:
            return
        lines = block.count(b"\n")
        read = None if self._below else columns_at_once(block, self._layout, self._columns, lines)
        read = read or self._careful(block)
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

    def _take_header(self, block: bytes) -> bytes:
        """Settle the layout; what is left of the block begins with the first sample."""
        lines = [line.decode() for line in block.split(b"\n", MOST_LINES)[:MOST_LINES]]
        lines = lines[: block.count(b"\n")]
        begin = self._unless_in_doubt(lambda: table_begin(lines, self._map, str(self._path)), self._line)
        self._layout = begin.layout
        self._layout.cells_expected = self._layout.cells_expected or len(self._layout.names)
        self._distance_s = counted_distance_s(lines[: begin.names])
        header = self._header = self._layout.names
        refuse_too_large(0, len(header), str(self._path))
        self._columns = {column: [] for column, name in enumerate(header) if name}
        unnamed = [number for number, name in enumerate(header, 1) if not name]
        if unnamed and self._layout.assigned is None:
            self._notes += [f"column {number} has no name and was left out" for number in unnamed]
        self._blank_lines += [0] * (begin.samples - 1)
        self._line += begin.samples
        return block.split(b"\n", begin.samples)[begin.samples]

    def _settle_decimal(self, block: bytes) -> None:
        some = block[:_SOME_BYTES].decode(errors="ignore").split("\n")[:-1]
        rows = [self._layout.cells(line) for line in some]
        self._unless_in_doubt(lambda: self._layout.settle_decimal(rows), self._line)
        self._notes += self._layout.notes

    def _unless_in_doubt(self, look: Callable[[], T], line: int) -> T:
        try:
            return look()
        except LayoutError as error:
            raise self._error(error.what, line + error.line, error.column, error.fix) from error

    def _settle_time(self, channels: dict[str, Array]) -> None:
        """Time in seconds; without a unit it may be milliseconds under the name of seconds."""
        time = channels.get(TIME, np.zeros(0))
        if self._distance_s and len(time) and np.isnan(time).all():
            time = np.asarray(np.arange(len(time), dtype=np.float64) * self._distance_s)
            channels[TIME] = time
            self._notes.append(f"time was counted: Delta_X in the preamble is {self._distance_s:g} s")
        if self._layout.assigned is None and self._layout.stamps is None and len(time):
            channels[TIME] = time = counted_on(time, self._notes)
        if self._layout.per_second != 1.0:
            channels[TIME] = time / self._layout.per_second
        if TIME not in channels or self._map:
            return
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

    def _careful(self, block: bytes) -> dict[int, Array]:
        """The block's columns, cell by cell; BadInputError names the first that cannot be read."""
        read: dict[int, list[float]] = {column: [] for column in self._columns}
        samples = self._samples
        for line, text in enumerate(block.decode().split("\n")[:-1], self._line):
            if not text.strip():
                self._blank_lines.append(samples)
                continue
            cells = self._layout.cells(text)
            if self._is_below(cells, line, first=samples == 0):
                continue
            if len(cells) != self._layout.cells_expected:
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

    def _is_below(self, cells: list[str], line: int, *, first: bool) -> bool:
        """Whether a line is no sample but one of those that may stand below the samples: text.

        Raises:
            BadInputError: samples follow such a line.
        """
        begin = cells[0].strip().strip('"*#=')
        time = self._header.index(TIME) if TIME in self._header else 0
        there = time < len(cells) and cells[time].strip()[:1].isalpha()
        text = begin[:1].isalpha() and (len(cells) != self._layout.cells_expected or there)
        if text and time < len(cells) and self._is_value(cells[time].strip(), time):
            text = False
        if text and len(self._below) < _MOST_BELOW and not first:
            self._below.append(
                self._wrong_number_of_cells(cells, line)
                if not there
                else self._no_number(cells[time].strip(), time, line)
            )
            return True
        if self._below:
            below = self._below[0]
            cut = "samples go on below this line: cut the file into its measurements"
            raise BadInputError(below.what, where=below.where, fix=cut)
        return False

    def _is_value(self, cell: str, column: int) -> bool:
        try:
            number_in(cell, self._layout, column)
        except ValueError:
            return False
        return True

    def _number(self, cell: str, column: int, line: int) -> float | None:
        """The cell's value, NaN if it is missing, None if it is text in a column that is not needed."""
        name = self._header[column]
        try:
            value = number_in(cell, self._layout, column)
        except ValueError:
            if not self._is_needed(name):
                return None
            raise self._no_number(cell, column, line) from None
        if math.isinf(value) and "inf" not in cell.lower() and self._is_needed(name):
            raise self._error(f"{_short(cell)} is beyond what a number can hold", line, name)
        return value

    def _is_needed(self, name: str) -> bool:
        return name in CHANNELS or name in self._map.sources

    def _no_number(self, cell: str, column: int, line: int) -> BadInputError:
        return self._error(f"{_short(cell)} is not a number", line, self._header[column], about_signs(cell))

    def _wrong_number_of_cells(self, cells: list[str], line: int) -> BadInputError:
        names = self._layout.cells_expected
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


def _short(cell: str) -> str:
    return repr(cell) if len(cell) <= 40 else f"{cell[:40]!r}…"
