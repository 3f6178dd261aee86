"""Telegrams in the style of the AK protocol for test benches: STX, text, ETX, over a serial line.

A request is `STX, blank, function code, blank, K<channel>, [blank, data…], ETX`; its answer repeats the code
and says a status in place of the channel: `STX, blank, function code, blank, status, [blank, data…], ETX`.
Status 0 is no error; with another the first datum says what is wrong. To an unknown function it is `????`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

STX, ETX = b"\x02", b"\x03"
LONGEST = 256  # bytes of a telegram; what goes on beyond is none
#: What the first datum of an answer with an error says.
BUSY, SYNTAX, DATA, OFFLINE, NOT_AVAILABLE = "BS", "SE", "DF", "OF", "NA"
UNKNOWN = "????"

_REQUEST = re.compile(r"[ -~]([A-Z][A-Z0-9]{3}) K(\d)((?: [!-~]+)*)")
_ANSWER = re.compile(r"[ -~]([A-Z][A-Z0-9]{3}|\?{4}) (\d)((?: [!-~]+)*)")


@dataclass(frozen=True)
class Request:
    """What a host asks of a channel."""

    function: str
    data: tuple[str, ...] = ()
    channel: int = 0

    def telegram(self) -> bytes:
        """Its bytes on the line."""
        return STX + " ".join((f" {self.function}", f"K{self.channel}", *self.data)).encode("ascii") + ETX


@dataclass(frozen=True)
class Answer:
    """What a device answers; `status` 0: no error."""

    function: str
    status: int = 0
    data: tuple[str, ...] = ()

    @property
    def error(self) -> str:
        """BS, SE, … if it refuses; '' if it does not."""
        if self.function == UNKNOWN:
            return NOT_AVAILABLE
        return (self.data[0] if self.data else SYNTAX) if self.status else ""

    def telegram(self) -> bytes:
        """Its bytes on the line."""
        return STX + " ".join((f" {self.function}", str(self.status), *self.data)).encode("ascii") + ETX


class Telegrams:
    """Cuts telegrams out of whatever comes on a line: pieces, garbage between them, halves."""

    def __init__(self) -> None:
        self._open: bytearray | None = None

    def feed(self, data: bytes) -> Iterator[str]:
        """The text of every telegram that `data` completes."""
        for byte in data:
            if byte == STX[0]:  # a new one begins, whatever became of the one before
                self._open = bytearray()
            elif self._open is None:
                continue
            elif byte == ETX[0]:
                whole, self._open = bytes(self._open), None
                yield whole.decode("ascii", errors="replace")
            elif len(self._open) == LONGEST:
                self._open = None
            else:
                self._open.append(byte)


def request_of(text: str) -> Request | None:
    """A telegram's text as a request; None if it is none."""
    found = _REQUEST.fullmatch(text)
    return Request(found[1], tuple(found[3].split()), int(found[2])) if found else None


def answer_of(text: str) -> Answer | None:
    """A telegram's text as an answer; None if it is none, such as the echo of a request."""
    found = _ANSWER.fullmatch(text)
    return Answer(found[1], int(found[2]), tuple(found[3].split())) if found else None
