"""ASC, BLF, TRC and candump logs, read by python-can message by message."""

from __future__ import annotations

import contextlib
import io
import logging
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO

import can

from hil.core.can.frames import FrameBlock
from hil.core.can_logs._asc_clock import on_one_clock
from hil.core.can_logs._busmaster import is_busmaster, messages_of
from hil.core.can_logs._log import (
    IMPOSSIBLE,
    LONG,
    LONGEST_DATA,
    REMOTE,
    SHORT,
    CanLog,
    LogClock,
    Stamps,
    block_of,
    flags_of,
    ordered,
)
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import of_the_system

_KINDS = {
    ".asc": "an ASC log",
    ".blf": "a BLF log",
    ".trc": "a TRC log",
    ".log": "a log of candump (-l or -L) or BusMaster",
}
_SINCE_1970_S = 1e8  # stamps below are none of wall-clock time: a log's own begin, an adapter's clock
_COUNTED_FROM_1 = (".asc", ".blf")  # python-can counts the channels of these from 0
_LARGEST_ID = 0x1FFF_FFFF
_LONGEST_LINE = 4096
_MOST_ODD = 1000  # lines of a file that is no candump log at all
_CANDUMP = re.compile(
    r"(\(\d+\.\d+\)\s+\S+\s+[0-9A-Fa-f]{3,8}#(?:#[0-9A-Fa-f]*|R[0-9A-Fa-f]?|(?:[0-9A-Fa-f]{2})*))(_[0-9A-Fa-f])?"
    r"(\s+[RT])?"
)
_STAMP = re.compile(r"\s*(\d+\.\d+)(?=\s)")

_BLF_HEADER = 16  # bytes that every object of a BLF has: signature, sizes, type
# What the readers find odd they also log; what matters of it is reported here.
logging.getLogger("can").addHandler(logging.NullHandler())


def read_messages(path: Path, stamps: Stamps = "") -> CanLog:
    """Frames of a log that python-can reads; of a broken one those before the break.

    Args:
        stamps: what to do where stamps go back: '' refuses, "append" takes what follows as recorded later,
            "sort" as written out of order.

    Raises:
        BadInputError: not one message of it can be read, or its stamps go back.
    """
    ending = path.suffix.lower()
    columns: dict[str, _Columns] = {}
    left_out: dict[str, int] = {}
    remarks: list[str] = []
    count = 0
    # A BLF keeps its objects in containers that are written when they are full: their order means nothing.
    clock = LogClock(stamps or "sort" if ending == ".blf" else stamps)
    try:
        for message in _messages(path, ending, stamps, remarks):
            count += 1
            kind = _misfit(message)
            if math.isfinite(message.timestamp):
                message.timestamp = clock.time_s(message.timestamp)
            if kind:
                left_out[kind] = left_out.get(kind, 0) + 1
            else:
                columns.setdefault(_name(message.channel, ending), _Columns()).add(message)
    except BadInputError:
        raise
    except OSError as error:
        raise of_the_system(error) from error
    except Exception as error:  # of many kinds, for whatever is broken
        if not count:
            raise BadInputError(
                f"is not {_KINDS[ending]}, or a broken one: {printable(error, 120) or type(error).__name__}",
                where=str(path),
                fix="give the log as the tool wrote it; its ending says of which kind it is",
            ) from error
        remarks.append(f"is broken after {count} frames; what came before was read")
    remarks += clock.settled(str(path))
    began_s = _began_s(columns)
    channels = {name: column.block(began_s or 0.0) for name, column in columns.items()}
    return CanLog(
        path, channels, None if began_s is None else round(began_s) * 1_000_000_000, left_out, remarks
    )


def _misfit(message: can.Message) -> str:
    """Why a recording has no place for a message; '' if it has."""
    if message.is_remote_frame:
        return REMOTE
    if len(message.data) > LONGEST_DATA:
        return LONG
    if not 0 <= message.arbitration_id <= _LARGEST_ID or not math.isfinite(message.timestamp):
        return IMPOSSIBLE
    return "" if message.is_error_frame or message.dlc == len(message.data) else SHORT


def _messages(path: Path, ending: str, stamps: Stamps, remarks: list[str]) -> Iterator[can.Message]:
    reader: Any
    if ending == ".asc":
        yield from _of_asc(path, stamps, remarks)
    elif ending == ".log" and is_busmaster(path):
        with _whole_lines(path, remarks) as text:
            yield from messages_of(text, remarks)
    elif ending == ".blf":
        with path.open("rb") as file, _BLFReader(file) as reader:
            yield from reader
            size = path.stat().st_size
            if size < reader.file_size:
                remarks.append(f"is cut off: {size} of {reader.file_size} bytes are there")
    else:
        with _whole_lines(path, remarks) as text:
            lines = text if ending == ".trc" else _CandumpLines(text, remarks)
            kind = can.TRCReader if ending == ".trc" else can.CanutilsLogReader
            with kind(lines) as reader:  # type: ignore[arg-type]
                yield from reader


class _CandumpLines(io.TextIOBase):
    """The lines of a candump log that are frames, as python-can takes them; others are counted.

    A length code above 8, which candump writes behind the data (`_E`), is left out: the data is 8 bytes then.
    """

    def __init__(self, file: Any, remarks: list[str]) -> None:
        self._file, self._remarks = file, remarks

    def __iter__(self) -> Iterator[str]:  # type: ignore[override]
        odd, first, number = 0, 0, 0
        frames = 0
        for number, line in enumerate(self._file, 1):
            found = _CANDUMP.fullmatch(line.rstrip())
            if found is not None:
                frames += 1
                yield f"{found[1]}{found[3] or ''}\n"
            elif line.strip():
                odd, first = odd + 1, first or number
                if not frames and odd >= _MOST_ODD:
                    raise ValueError(f"line {first} is no frame")
        if odd and not frames:
            raise ValueError(f"line {first} is no frame")
        if odd:
            lines = "1 line is" if odd == 1 else f"{odd} lines are"
            self._remarks.append(f"{lines} no frame and left out, the first is line {first}")

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()
        super().close()


class _BLFReader(can.BLFReader):
    """python-can's, which would read an object of no length again and again, for ever."""

    def _parse_data(self, data: bytes) -> Iterator[can.Message]:
        at = data.find(b"LOBJ", 0, 8)
        while at >= 0 and at + _BLF_HEADER <= len(data):
            size = int.from_bytes(data[at + 8 : at + 12], "little")
            if size < _BLF_HEADER:
                raise ValueError(f"an object of {size} bytes")
            at = data.find(b"LOBJ", at + size, at + size + 8)
        yield from super()._parse_data(data)


def _whole_lines(path: Path, remarks: list[str]) -> Any:
    """The text of a log without a last line that is cut off: half a frame would be another one."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - _LONGEST_LINE))
        tail = file.read()
    if tail.endswith(b"\n") or path.suffix.lower() != ".log":  # other tools need not end their last line
        return path.open(encoding="cp1252", errors="replace")
    remarks.append("its last line is cut off, and was left out")
    return _WithoutLastLine(path.open(encoding="cp1252", errors="replace"))


class _WithoutLastLine(io.TextIOBase):
    """A text whose last line, which has no end, is left out; no line is longer than any of a log.

    Raises:
        ValueError: a line is.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file

    def __iter__(self) -> Iterator[str]:  # type: ignore[override]
        while line := self._file.readline(_LONGEST_LINE):
            if line.endswith("\n"):
                yield line
            elif len(line) >= _LONGEST_LINE:
                raise ValueError(f"a line of more than {_LONGEST_LINE} characters")

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()
        super().close()


def _of_asc(path: Path, stamps: Stamps, remarks: list[str]) -> Iterator[can.Message]:
    """Messages of an ASC log with the day that its head names, if it is written as python-can knows it."""
    with _whole_lines(path, remarks) as file:
        text = _with_whole_head(on_one_clock(_summed(file.read()), stamps, str(path), remarks))
    try:
        next(iter(can.ASCReader(io.StringIO(text), relative_timestamp=False)), None)
        relative = False
    except ValueError:  # a day in another language: the frames are read all the same
        relative = True
        remarks.append("the day in its head cannot be read: its stamps count from its beginning")
    with can.ASCReader(io.StringIO(text), relative_timestamp=relative) as reader:
        yield from reader


def _with_whole_head(text: str) -> str:
    """With the line that ends a head, where it is missing: python-can would take the first frame for it."""
    if re.search(r"^\s*(no\s+)?internal\s+events\s+logged", text, re.IGNORECASE | re.MULTILINE):
        return text
    first = re.search(r"^\s*(\d|begin)", text, re.IGNORECASE | re.MULTILINE)
    place = first.start() if first else len(text)
    return f"{text[:place]}internal events logged\n{text[place:]}"


def _summed(text: str) -> str:
    """With stamps that count from the line before, those that count from the beginning in their place."""
    if not re.search(r"^base\s+\w+\s+timestamps\s+relative", text, re.IGNORECASE | re.MULTILINE):
        return text
    since_s, lines = 0.0, []
    for line in text.splitlines(keepends=True):
        stamp = _STAMP.match(line)
        if stamp:
            since_s += float(stamp.group(1))
            line = f"{since_s:.6f}{line[stamp.end() :]}"
        lines.append(line)
    return "".join(lines)


def _name(channel: object, ending: str) -> str:
    if channel is None:
        return "1"
    if isinstance(channel, int) and ending in _COUNTED_FROM_1:
        return str(channel + 1)
    return printable(channel)


@dataclass
class _Columns:
    """Frames of one channel as they are read."""

    times_s: list[float] = field(default_factory=list)
    ids: list[int] = field(default_factory=list)
    flags: list[int] = field(default_factory=list)
    lengths: list[int] = field(default_factory=list)
    data: list[int] = field(default_factory=list)

    def add(self, message: can.Message) -> None:
        """Take a message that fits."""
        self.times_s.append(message.timestamp)
        self.ids.append(message.arbitration_id)
        self.flags.append(
            flags_of(extended=message.is_extended_id, sent=not message.is_rx, error=message.is_error_frame)
        )
        self.lengths.append(len(message.data))
        self.data.append(int.from_bytes(message.data, "little"))

    def block(self, began_s: float) -> FrameBlock:
        """What was taken, with stamps from `began_s` on."""
        block = block_of(self.times_s, self.ids, self.flags, self.lengths, self.data)
        block["time_s"] -= began_s
        return ordered(block)


def _began_s(columns: dict[str, _Columns]) -> float | None:
    """The whole second since 1970 in which the log begins; None if its stamps do not count from there."""
    with contextlib.suppress(ValueError):  # no frame at all
        first_s = min(min(column.times_s) for column in columns.values())
        if first_s > _SINCE_1970_S:
            return float(math.floor(first_s))
    return None
