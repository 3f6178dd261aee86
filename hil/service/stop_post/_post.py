"""The service's side of its stop post: begins it, gives it the stop lines of runs, hears who has stopped."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import os
import socket
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from hil.execution.background import start_process
from hil.service.stop_post._messages import (
    Benches,
    Line,
    Message,
    OwnBench,
    Owner,
    Owners,
    Reset,
    Stopped,
    Up,
    from_line,
    to_line,
)

_AGAIN_S = 0.5
_AT_ONCE = 1 << 16
_BUFFER_BYTES = 1 << 20

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class StopLine:
    """Both ends of the pipe by which a run is stopped; `reading` is the run's."""

    line: Line
    reading: int
    writing: int


class StopPost:
    """The stop post: a process that takes emergency stops, whatever the service is doing.

    Args:
        listening: where it takes them.
        hosts: names by which browsers may call it.
        proxies: addresses of proxies before it.

    Attributes:
        stopped: called with each stop that it tells of.
    """

    def __init__(
        self,
        listening: socket.socket,
        hosts: Sequence[str],
        proxies: Sequence[str],
    ) -> None:
        self._listening = listening
        self.stopped: Callable[[Stopped], None] = lambda stopped: None
        self._settings = json.dumps({"hosts": list(hosts), "proxies": list(proxies)})
        self._benches, self._owners = Benches(own={}), Owners(by_sha256={})
        self._lines: dict[int, StopLine] = {}
        self._control: socket.socket | None = None
        self._unread = bytearray()
        self._up = asyncio.Event()
        self._closing = False

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self._listening.getsockname()[1])

    async def work(self) -> None:
        """Keep it running until `close`: one that has ended, whatever ended it, is started anew."""
        while not self._closing:
            try:
                process = await self._begin()
            except OSError as error:
                logger.error("the stop post cannot be started: %s", error)
            else:
                code = await process.wait()
                self._let_go()
                if not self._closing:
                    logger.error("the stop post ended with code %s; it is started anew", code)
            if not self._closing:
                await asyncio.sleep(_AGAIN_S)

    async def until_up(self, within_s: float) -> bool:
        """Whether it answers, at the latest after a while."""
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._up.wait(), within_s)
        return self._up.is_set()

    @property
    def up(self) -> bool:
        """Whether it answers."""
        return self._up.is_set()

    def know_benches(self, own: Mapping[str, OwnBench], others: Sequence[str]) -> None:
        """Which benches there are: the service's own with their files and stops, and those of agents."""
        benches = Benches(own=dict(own), others=sorted(others))
        if benches != self._benches:
            self._benches = benches
            self._say(benches)

    def know_owners(self, owners: Mapping[str, Owner]) -> None:
        """Whose tokens and sessions are, by the SHA-256 of their secrets."""
        found = Owners(by_sha256=dict(owners))
        if found != self._owners:
            self._owners = found
            self._say(found)

    def reset(self, bench: str) -> None:
        """Somebody has let a bench be armed again."""
        self._say(Reset(bench=bench))

    def add_line(self, bench: str, run: int, folder: Path) -> StopLine:
        """A stop line for a run that is about to begin; close its `reading` once the run has it.

        Raises:
            OSError: no descriptor is left.
        """
        reading, writing = os.pipe()
        found = StopLine(Line(bench=bench, run=run, folder=str(folder)), reading, writing)
        self._lines[run] = found
        self._say(found.line, writing)
        return found

    def drop_line(self, run: int) -> None:
        """A run has ended."""
        found = self._lines.pop(run, None)
        if found is not None:
            os.close(found.writing)

    def close(self) -> None:
        """End it."""
        self._closing = True
        self._let_go()
        for run in list(self._lines):
            self.drop_line(run)

    async def _begin(self) -> asyncio.subprocess.Process:
        ours, theirs = socket.socketpair()
        with theirs:
            ours.setblocking(False)
            ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _BUFFER_BYTES)
            descriptors = theirs.fileno(), self._listening.fileno()
            process = await start_process(
                sys.executable,
                "-m",
                __package__,
                *map(str, descriptors),
                self._settings,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.DEVNULL,
                pass_fds=descriptors,
            )
        self._control, self._unread = ours, bytearray()
        asyncio.get_running_loop().add_reader(ours, self._hear)
        for message in (self._benches, self._owners):
            self._say(message)
        for one in self._lines.values():
            self._say(one.line, one.writing)
        return process

    def _let_go(self) -> None:
        self._up.clear()
        if self._control is not None:
            with contextlib.suppress(RuntimeError):
                asyncio.get_running_loop().remove_reader(self._control)
            self._control.close()
            self._control = None

    def _say(self, message: Message, descriptor: int | None = None) -> None:
        """Tell it, if it is there; one that does not read is given up, and the next hears all."""
        if self._control is None:
            return
        data = to_line(message)
        try:
            if descriptor is not None:
                sent = socket.send_fds(self._control, [data], [descriptor])
            else:
                sent = self._control.send(data)
        except OSError as error:
            logger.error("the stop post does not hear: %s", error)
            sent = -1
        if sent != len(data):
            self._let_go()  # it ends when no one is at the other end

    def _hear(self) -> None:
        assert self._control is not None
        try:
            data = self._control.recv(_AT_ONCE)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._let_go()
            return
        self._unread += data
        *lines, self._unread = self._unread.split(b"\n")
        for line in lines:
            try:
                message = from_line(bytes(line))
            except ValidationError:
                logger.exception("internal error")
                continue
            if isinstance(message, Up):
                self._up.set()
            elif isinstance(message, Stopped):
                self.stopped(message)
