"""Runs on the agent's disk: written down before they are started, kept until the service has them whole.

The recording is brought there as it grows, everything else once the run has ended.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import logging
import os
import shutil
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from pydantic import ValidationError

from hil.agent._service import AwayError, TheService
from hil.api_schemas.agent import MOST_PIECE_BYTES, FileMade, RunEnding, TakenRun
from hil.client import RefusedError
from hil.core.files import make_directory, sha256_of, write_atomically
from hil.engine import RECORDING
from hil.execution.background import apart
from hil.execution.data_folder import files_in, folder_of

_TAKEN, _ENDING, _INPUTS = ".taken.json", ".ending.json", ".inputs"
_DELIVERED, _REFUSED = ".delivered", ".refused"
_DAY_S = 86400.0


class KeptRun:
    """A run in its folder; `ending` is None until it has ended, `ended_s` then in seconds since 1970."""

    def __init__(self, folder: Path, taken: TakenRun, ending: RunEnding | None = None) -> None:
        self.folder, self.ending = folder, ending
        source = folder / _INPUTS / Path(taken.plan_source).name
        self.taken = taken.model_copy(update={"plan_source": str(source)})
        self.id, self.bench = taken.data.id, taken.data.bench

    def end(self, ending: RunEnding, at: datetime.datetime | None = None) -> None:
        """Keep how it ended, and when if that was not just now.

        Raises:
            HilError: it cannot be written.
        """
        place = self.folder / _ENDING
        write_atomically(place, ending.model_dump_json())
        if at is not None:
            with contextlib.suppress(OSError):  # then it ended when it was looked at
                os.utime(place, (at.timestamp(), at.timestamp()))
        self.ending = ending

    def files(self) -> list[FileMade]:
        """What it left, as it is on the disk; reads all of it.

        Raises:
            BadInputError: a file cannot be read.
        """
        made = []
        for path in files_in(self.folder):
            with contextlib.suppress(ValidationError):  # a name that is no name for others
                made.append(FileMade(name=path.name, size=path.stat().st_size, sha256=sha256_of(path)))
        return made

    def ending_with(self, files: list[FileMade]) -> RunEnding:
        """How it ended, as it is reported now."""
        assert self.ending is not None
        made = files if self.ending.state != "queued" else []
        ago_s = max(0.0, time.time() - (self.folder / _ENDING).stat().st_mtime)
        return self.ending.model_copy(update={"files": made, "ago_s": ago_s})

    def over(self, refused: str = "") -> None:
        """The service has it, or will not have it, for a reason; its files stay.

        Raises:
            HilError: it cannot be written.
        """
        write_atomically(self.folder / (_REFUSED if refused else _DELIVERED), refused)


class KeptRuns:
    """Runs that the agent has taken, each in a folder by its number.

    Args:
        folder: made if it is not there.
        local_days: how long files stay here that the service has.
    """

    def __init__(self, folder: Path, local_days: float) -> None:
        self._folder, self._local_s = folder, local_days * _DAY_S
        make_directory(folder, option="--data")

    def pending(self) -> Iterator[KeptRun]:
        """Those that the service has not, oldest first."""
        for path in sorted(self._folder.glob(f"[0-9]*/{_TAKEN}")):
            folder = path.parent
            if not folder.name.isdecimal():  # put aside by `begin`
                continue
            if (folder / _DELIVERED).exists() or (folder / _REFUSED).exists():
                continue
            with contextlib.suppress(OSError, ValueError):
                taken = TakenRun.model_validate_json(path.read_bytes())
                ending = None
                if (folder / _ENDING).exists():
                    ending = RunEnding.model_validate_json((folder / _ENDING).read_bytes())
                yield KeptRun(folder, taken, ending)

    def begin(self, taken: TakenRun) -> KeptRun:
        """Keep that a run was taken, before anything of it is started, and what its plan loads.

        Raises:
            HilError: it cannot be written.
        """
        folder = folder_of(self._folder, taken.data.id)
        if (folder / _TAKEN).exists():  # of another service, or one whose database was put back
            folder.rename(f"{folder}.before-{time.time_ns()}")
        elif folder.exists():  # nothing of it was started
            shutil.rmtree(folder)
        inputs = folder / _INPUTS
        make_directory(inputs)
        for name, text in taken.files.items():
            write_atomically(inputs / Path(name).name, text)
        run = KeptRun(folder, taken)
        write_atomically(Path(run.taken.plan_source), taken.plan_text)
        write_atomically(folder / _TAKEN, taken.model_dump_json())
        return run

    def clear(self) -> None:
        """Remove runs that the service has had for long enough."""
        for mark in list(self._folder.glob(f"[0-9]*/{_DELIVERED}")):
            with contextlib.suppress(OSError):
                if time.time() - mark.stat().st_mtime > self._local_s:
                    shutil.rmtree(mark.parent)


_LOOK_S = 0.2  # how often a recording that grows is looked at
_AGAIN_S = 1.0
_LONGEST_S = 30.0  # between two tries
_ROUNDS = 3  # of sending what did not come whole, before everything is looked at anew
_NOT_MINE = (401, 403)  # until somebody puts the token right

logger = logging.getLogger(__name__)


class Deliveries:
    """Files of runs on their way. What cannot be brought now stays, and is brought later."""

    def __init__(self, service: TheService, agent: str) -> None:
        self._service, self._agent = service, agent

    async def stream(self, run: KeptRun, going: Callable[[], bool]) -> None:
        """Send the recording as it grows, as long as the run goes on; nothing is lost by what goes wrong."""
        at = 0
        while going():
            try:
                sent = await self._send(run, RECORDING, at)
            except AwayError:
                await asyncio.sleep(_AGAIN_S)
            except RefusedError:
                return
            else:
                at, more = sent
                await asyncio.sleep(0.0 if more else _LOOK_S)

    async def deliver(self, run: KeptRun) -> str:
        """Bring a run that has ended; the service's reason if it will not have it.

        Raises:
            HilError: its files cannot be read.
        """
        wait_s, files = _AGAIN_S, await apart(run.files)
        while True:
            answers = self._service.answers
            ending = run.ending_with(files)
            try:
                if await self._brought(run, ending):
                    return ""
                files = await apart(run.files)
            except AwayError:
                pass
            except RefusedError as error:
                if error.status not in _NOT_MINE:
                    return "" if ending.state == "queued" else str(error)
                logger.warning("run %d is not taken: %s", run.id, error.what)
            answered = self._service.answers > answers  # only some of it was lost
            wait_s = _AGAIN_S if answered else min(2.0 * wait_s, _LONGEST_S)
            await asyncio.sleep(wait_s)

    async def _brought(self, run: KeptRun, ending: RunEnding) -> bool:
        """Send what is missing; false if it does not become what was made."""
        for _ in range(_ROUNDS):
            answer = await self._service.ask(lambda client: client.deliver(self._agent, run.id, ending))
            if not answer.missing:
                return True
            for name in answer.missing:
                await self._send_all(run, name)
        return False

    async def _send_all(self, run: KeptRun, name: str) -> None:
        at, more = 0, True
        while more:
            at, more = await self._send(run, name, at)

    async def _send(self, run: KeptRun, name: str, at: int) -> tuple[int, bool]:
        """Send a piece from `at`; where to go on, and whether there is more by now."""
        piece = await apart(partial(_piece, run.folder / name, at))
        there = await self._service.ask(lambda client: client.send(self._agent, run.id, name, at, piece))
        size = _size(run.folder / name)
        return there.size, there.size < size and there.size != at


def _piece(path: Path, at: int) -> bytes:
    try:
        with path.open("rb") as file:
            file.seek(at)
            return file.read(MOST_PIECE_BYTES)
    except OSError:
        return b""


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
