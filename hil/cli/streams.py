"""Standard streams that cannot surprise a command, and the operator's terminal.

Streams may be closed, full, cut off by their reader, or ASCII only. Lines that the operator types are
read without ever waiting for them.
"""

from __future__ import annotations

import codecs
import contextlib
import errno
import io
import os
import select
import sys
from typing import TYPE_CHECKING, TextIO

from hil.core.errors.wording import printable

if TYPE_CHECKING:
    from hil.engine.ipc.ipc_messages import Question

#: The reader has gone: no one is left to complain to, and the command's outcome is its own.
_READER_GONE = (errno.EPIPE, errno.EIO, errno.EBADF)
_LONGEST_LINE = 2000
_PLAIN = {
    "≤": "<=", "≥": ">=", "±": "+-", "²": "^2", "·": "*", "×": "x", "–": "-", "—": "-", "−": "-", "…": "...",
    "°": " deg", "µ": "u", "μ": "u", "ω": "omega", "ζ": "zeta", "α": "alpha", "τ": "tau", "σ": "sigma",
    "θ": "theta", "✓": "ok", "✗": "x", "‹": "<", "›": ">", "\u2019": "'", "“": '"', "”": '"',
}  # fmt: skip


class TolerantOutput(io.RawIOBase):
    """A file descriptor that swallows what cannot be written; `failure` says why the rest is missing.

    A reader that closed its end is no failure.
    """

    def __init__(self, descriptor: int) -> None:
        super().__init__()
        self._descriptor = descriptor
        self._lost = False
        self.failure: OSError | None = None

    def writable(self) -> bool:
        """Always."""
        return True

    def fileno(self) -> int:
        """The descriptor, for those who ask what it is."""
        return self._descriptor

    def isatty(self) -> bool:
        """Whether a person is looking."""
        return os.isatty(self._descriptor)

    def write(self, data: object) -> int:
        """Write everything, or nothing from the first failure on."""
        rest = memoryview(data).cast("B")  # type: ignore[arg-type]
        size = len(rest)
        while rest and not self._lost:
            try:
                rest = rest[os.write(self._descriptor, rest) :]
            except OSError as error:
                self._lost = True
                self.failure = None if error.errno in _READER_GONE else error
        return size


def tolerate_outputs() -> tuple[TolerantOutput, TolerantOutput]:
    """Put tolerant streams in the place of stdout and stderr; closed ones lead nowhere.

    Without descriptors 0 to 2 the next file that is opened would become standard output.
    """
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.dup2(os.open(os.devnull, os.O_RDWR), descriptor)
    codecs.register_error("plain", _in_plain_words)
    raw = TolerantOutput(1), TolerantOutput(2)
    sys.stdout, sys.stderr = _text(raw[0], sys.stdout), _text(raw[1], sys.stderr)
    if sys.stdin is None:
        sys.stdin = open(0, closefd=False)  # noqa: SIM115 - a descriptor that stays open
    return raw


def complain(kind: str, text: str) -> None:
    """Say `kind: text` on standard error, with what cannot be printed in it escaped."""
    lines = [printable(line, longest=_LONGEST_LINE) for line in text.split("\n")]
    print(f"{kind}: " + "\n".join(lines), file=sys.stderr)


def _text(raw: TolerantOutput, like: TextIO | None) -> TextIO:
    encoding = like.encoding if like is not None else "utf-8"
    buffered = io.BufferedWriter(raw)
    return io.TextIOWrapper(buffered, encoding=encoding, errors="plain", line_buffering=raw.isatty())


def _in_plain_words(error: UnicodeError) -> tuple[str, int]:
    """What an ASCII terminal reads for a character that it does not have."""
    assert isinstance(error, UnicodeEncodeError)
    missing = error.object[error.start : error.end]
    plain = "".join(
        _PLAIN.get(c, f"\\u{ord(c):04x}" if ord(c) < 0x10000 else f"\\U{ord(c):08x}") for c in missing
    )
    return plain, error.end


KEYS = "p + Enter: pause, q + Enter: end, e + Enter: emergency stop"
_LONGEST_TYPED_LINE = 1000


class StandardTerminal:
    """Standard input and standard error.

    Lines are read only when some have come and this process is in the foreground: who reads a terminal from
    the background is stopped by the system, with torque on.
    """

    def __init__(self) -> None:
        self._descriptor = sys.stdin.fileno()
        self._begun = b""

    def tell(self, text: str, question: Question | None = None) -> None:
        """Show a text; a picture by its name."""
        picture = f"\nPicture: {question.picture}" if question is not None and question.picture else ""
        print(f"\n{text}{picture}", file=sys.stderr)

    def typed(self) -> list[str]:
        """Lines that were typed since the last call; an end of file is none."""
        with contextlib.suppress(OSError):
            while self._ready() and (data := os.read(self._descriptor, _LONGEST_TYPED_LINE)):
                self._begun += data
        *lines, self._begun = self._begun.split(b"\n")
        self._begun = self._begun[-_LONGEST_TYPED_LINE:]
        return [line.decode("utf-8", "replace") for line in lines]

    def _ready(self) -> bool:
        if os.tcgetpgrp(self._descriptor) != os.getpgrp():
            return False
        return bool(select.select([self._descriptor], [], [], 0.0)[0])


def operators_terminal() -> StandardTerminal | None:
    """Who sits at standard input; None if no one does, or the system has no such terminals."""
    if not sys.stdin.isatty() or not hasattr(os, "tcgetpgrp"):
        return None
    return StandardTerminal()
