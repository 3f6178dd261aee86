"""A use case in a process of its own, which the next service finds if this one is killed."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
from pathlib import Path

from hil.app.worker.job import JOB, write_request
from hil.core.files import write_atomically
from hil.execution.background import STUDY_BYTES, start_process

_NICENESS = 10
_NUMBER = "process"


class JobProcess:
    """A job under way; `begin` makes one."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    @classmethod
    async def begin(cls, request: object, folder: Path) -> JobProcess:
        """Begin one; what is wanted, and the number of its process, are kept in `folder`.

        Raises:
            HilError: the folder cannot be written.
            OSError: it cannot be started.
        """
        write_request(folder, request)
        process = await start_process(
            *JOB,
            str(folder.resolve()),
            niceness=_NICENESS,
            most_bytes=STUDY_BYTES,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        write_atomically(folder / _NUMBER, str(process.pid))
        return cls(process)

    async def over(self) -> tuple[int, str]:
        """Its exit code, and why it failed, once it has ended."""
        _, complaint = await self._process.communicate()
        code = self._process.returncode or 0
        reason = complaint.decode("utf-8", "replace").removeprefix("error: ").strip() if code else ""
        return code, reason or f"exit code {code}"

    def interrupt(self) -> None:
        """As Ctrl-C: it writes what it knows and ends; twice, it ends at once."""
        with contextlib.suppress(ProcessLookupError):
            self._process.send_signal(signal.SIGINT)

    def kill(self) -> None:
        """End it and whatever it has started, now."""
        if self._process.returncode is None:
            _kill_session(self._process.pid)

    async def end(self, within_s: float) -> None:
        """Interrupt it, and kill it if it takes longer."""
        if self._process.returncode is not None:
            return
        self.interrupt()
        try:
            await asyncio.wait_for(self._process.communicate(), within_s)
        except TimeoutError:
            self.kill()
            await self._process.wait()


def kill_left(folder: Path) -> None:
    """End the process that a killed service has left at work in this folder."""
    with contextlib.suppress(OSError, ValueError):
        process = int((folder / _NUMBER).read_text("utf-8"))
        called = Path(f"/proc/{process}/cmdline").read_bytes()
        if os.fsencode(folder.resolve()) in called.split(b"\0"):
            _kill_session(process)


def _kill_session(process: int) -> None:
    """`started` gave it a session of its own, and so a group that has its number."""
    with contextlib.suppress(OSError):
        os.killpg(process, signal.SIGKILL)
