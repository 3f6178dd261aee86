"""The service's side of its worker processes: questions out, answers in, each a line of JSON."""

from __future__ import annotations

import asyncio
import contextlib
import json
import signal
import sys
from typing import Any

from hil.core.errors import BadInputError, BenchError
from hil.execution.background import FORECAST_BYTES, start_process
from hil.service.plain_words import in_plain_words, names_in

_WITHIN_S = 60.0
#: What an answer begins with; JSON follows.
ANSWERED, REFUSED = b"+", b"-"
#: Reading what people give may take so much of a processor, however busy that is; 240 kB of YAML need 2 s.
READING, READ_WITHIN_S = "read_", 5.0
_LONGEST_ANSWER_BYTES = 1 << 26


class TooLongError(BenchError):
    """Reading took too much of a processor, and its process was ended."""


class WorkerPool:
    """A process that answers one question after the other; started with the first, ended when no one asks.

    Args:
        niceness: added to that of the service.
        read_within_s: of a processor, for what people give.
        within_s: for any answer.
    """

    def __init__(
        self, niceness: int, read_within_s: float = READ_WITHIN_S, within_s: float = _WITHIN_S
    ) -> None:
        self._niceness, self._read_within_s, self._within_s = niceness, read_within_s, within_s
        self._turn = asyncio.Lock()
        self._process: asyncio.subprocess.Process | None = None

    async def ask(self, task: str, **asked: object) -> dict[str, Any]:
        """What one of the tasks in `__main__` gives for arguments of JSON.

        Raises:
            HilError: as of `ask_text`.
        """
        found: dict[str, Any] = json.loads(await self.ask_text(task, **asked))
        return found

    async def ask_text(self, task: str, **asked: object) -> bytes:
        """The same as the JSON that it is.

        Raises:
            BadInputError: what was asked cannot be answered.
            BenchError: it took too long, or its process failed.
        """
        question = (
            json.dumps({"task": task, "asked": asked, "read_within_s": self._read_within_s}).encode() + b"\n"
        )
        async with self._turn:
            try:
                line = await asyncio.wait_for(self._answer(question), self._within_s)
            except BaseException as error:
                self.close()  # its answer would be taken for the next question's
                if isinstance(error, TimeoutError):
                    raise BenchError(f"took more than {self._within_s:g} s", where=task) from error
                raise
        if not line:
            raise BenchError("its process ended", where=task, fix="look at the service's log")
        return _read(line, names_in(asked))

    def close(self) -> None:
        """End the process, whatever it does."""
        if self._process is not None:
            with contextlib.suppress(ProcessLookupError):
                self._process.kill()
        self._process = None

    async def _answer(self, question: bytes) -> bytes:
        """The line that answers; a process that had just ended for want of questions is started again."""
        was_there = self._process is not None
        line = await self._ask(question)
        return line or (await self._ask(question) if was_there else b"")

    async def _ask(self, question: bytes) -> bytes:
        process = self._process or await self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(ConnectionError):
            process.stdin.write(question)
            await process.stdin.drain()
        line = await process.stdout.readline()
        if not line:
            code = await process.wait()
            self._process = None
            if code == -signal.SIGVTALRM:
                what = f"took more than {self._read_within_s:g} s of a processor"
                raise TooLongError(what, where="reading")
        return line

    async def _start(self) -> asyncio.subprocess.Process:
        self._process = await start_process(
            sys.executable,
            "-m",
            __package__,
            niceness=self._niceness,
            most_bytes=FORECAST_BYTES,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            limit=_LONGEST_ANSWER_BYTES,
        )
        return self._process


def _read(line: bytes, names: dict[str, str]) -> bytes:
    if line.startswith(ANSWERED):
        return line[len(ANSWERED) :]
    refused = json.loads(line[len(REFUSED) :])
    kind = BadInputError if refused["bad_input"] else BenchError
    parts = (refused[part] for part in ("what", "where", "fix"))
    what, where, fix = (in_plain_words(part, names, hide_places=False) for part in parts)
    raise kind(what, where=where, fix=fix)
