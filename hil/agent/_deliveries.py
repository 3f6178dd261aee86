"""Brings to the service what runs leave: the recording as it grows, everything once they have ended."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from functools import partial
from pathlib import Path

from hil.agent._kept_runs import KeptRun
from hil.agent._service import AwayError, TheService
from hil.api_schemas.agent import MOST_PIECE_BYTES, RunEnding
from hil.client import RefusedError
from hil.engine import RECORDING
from hil.execution.daemon_thread import apart

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
