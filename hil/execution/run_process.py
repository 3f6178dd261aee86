"""A run's own process: started, instructed, listened to. It is what `hil run` is, without a terminal."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from pathlib import Path

from hil.app.worker.served_run import RUNNER
from hil.core.errors import BenchError
from hil.core.files.locks import HeldError, lock_on
from hil.core.result import RunResult
from hil.engine.ipc.ipc_messages import EmergencyAsked, Message, RunAsked, Typed, from_line, to_line
from hil.engine.run.operator import END, GONE, PAUSE, RESUME
from hil.execution.background import start_process
from hil.execution.data_folder import LOCK

RESULT = "result.json"
_LONGEST_LINE = 1 << 24


class RunProcess:
    """One run in a process of its own, which ends its run by itself when the service is gone.

    `answered` is called when somebody answered what a run which is held, or asks, waits for.
    """

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self.answered: Callable[[], None] = lambda: None

    @classmethod
    async def begin(cls, asked: RunAsked, stop_line: int | None = None) -> RunProcess:
        """Start the process and tell it what to do.

        Args:
            stop_line: a descriptor from which it takes emergency stops, besides the requests of this one.

        Raises:
            OSError: it cannot be started, or its folder cannot be written.
        """
        alive = Path(asked.out) / LOCK
        alive.touch()
        with lock_on(alive) as lock:
            process = await start_process(
                *RUNNER,
                Path(asked.out).name,
                *([] if stop_line is None else [str(stop_line)]),
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.DEVNULL,
                pass_fds=[lock] if stop_line is None else [lock, stop_line],
                limit=_LONGEST_LINE,
            )
        run = cls(process)
        run._say(asked)
        return run

    def pause(self) -> None:
        """Hold the run at its next safe point."""
        self._say(Typed(line=PAUSE))

    def resume(self) -> None:
        """Let a run go on that is held."""
        self._say(Typed(line=RESUME))
        self.answered()

    def end(self) -> None:
        """End the run, with its end steps."""
        self._say(Typed(line=END))
        self.answered()

    def leave(self) -> None:
        """End the run, with its end steps, because who executes it ends."""
        self._say(Typed(line=GONE))
        self.answered()

    def stop_in_emergency(self, asked: EmergencyAsked) -> None:
        """Have the bench safe at once."""
        self._say(asked)
        self.answered()

    def answer(self, text: str) -> None:
        """A line for the operator's prompt."""
        self._say(Typed(line=text))
        self.answered()

    async def messages(self) -> AsyncIterator[Message]:
        """What it says, until it has ended."""
        assert self._process.stdout is not None
        while line := await self._process.stdout.readline():
            with contextlib.suppress(BenchError):  # a line that was cut off by its end
                yield from_line(line)

    async def exit_code(self) -> int:
        """As `hil run` has it; 3 if it was killed."""
        code = await self._process.wait()
        return code if code >= 0 else BenchError.exit_code

    def _say(self, message: Message) -> None:
        if self._process.stdin is not None and not self._process.stdin.is_closing():
            self._process.stdin.write(to_line(message))


def alive_in(folder: Path) -> bool:
    """Whether a process still works in a run's folder: the run's own, or the one that holds the bench."""
    for place in (folder / LOCK, folder):
        try:
            with lock_on(place):
                pass
        except HeldError:
            return True
        except OSError:
            continue
    return False


def result_in(folder: Path) -> RunResult | None:
    """The result that a run has left, if it came so far."""
    try:
        return RunResult.model_validate_json((folder / RESULT).read_bytes())
    except (OSError, ValueError):
        return None
