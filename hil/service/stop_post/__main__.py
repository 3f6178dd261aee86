"""`python -m hil.service.stop_post`: the process behind the stop post; the service starts it, no one else.

It has what an emergency stop needs and nothing else: a socket that listens, a stop line of each run under
way, and names of those who may ask. No database, no parser, no pool and no lock of the service is on its way.
"""

from __future__ import annotations

import json
import logging
import os
import queue
import selectors
import signal
import socket
import sys
from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path

from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.engine.ipc.ipc_messages import to_line as to_run
from hil.service.connection_limit import allow_all_descriptors
from hil.service.stop_post._answering import Answering, Asked, Listener, RefusedError, answer, refusal
from hil.service.stop_post._latches import Latched, Latches
from hil.service.stop_post._messages import (
    Benches,
    Line,
    Message,
    Owners,
    Reset,
    Stopped,
    Up,
    from_line,
    to_line,
)

_LOOK_S = 0.5
_MOST_REPORTED = 16  # who asks for a stop that there is already the service hears of so many times
_AT_ONCE = 1 << 16

logger = logging.getLogger(__name__)


class StopPostProcess:
    """Takes stops, tells runs, latches benches, says so to the service."""

    def __init__(self, control: socket.socket, listening: socket.socket, answering: Answering) -> None:
        self._control, self._answering = control, answering
        self._benches = Benches(own={})
        self._lines: dict[int, Line] = {}  # by descriptor
        self._pending: dict[str, Asked] = {}  # asked for, and not known to be on the disk
        self._being_latched: set[str] = set()  # the disk has not answered yet
        self._reported: dict[str, set[tuple[str, str]]] = {}
        self._unread, self._descriptors = bytearray(), list[int]()
        self._latched: queue.SimpleQueue[Latched] = queue.SimpleQueue()
        self._bell, self._hammer = socket.socketpair()
        self._selector = selectors.DefaultSelector()
        self._latches = Latches(self._ring)
        for one in (control, listening, self._bell, self._hammer):
            one.setblocking(False)
        self._selector.register(control, selectors.EVENT_READ, self._hear)
        self._selector.register(self._bell, selectors.EVENT_READ, self._take_latched)
        self._listener = Listener(self._selector, listening, self._answer)
        self._ended = False

    def work(self) -> None:
        """Until the service has ended."""
        self._tell(Up())
        while not self._ended:
            for key, _ in self._selector.select(_LOOK_S):
                work: Callable[[], None] = key.data
                try:
                    work()
                except Exception:  # nothing that one caller does may end it for all
                    logger.exception("internal error")
            self._listener.close_late()

    def _answer(self, head: bytes, address: str) -> bytes:
        origin = self._answering.allowed_origin(head)
        try:
            asked = self._answering.asked(head, address)
            if asked is None:
                return answer(HTTPStatus.OK, {"stop_post": True}, origin)
            stopped = self._stop(asked)
        except RefusedError as error:
            return refusal(error)
        return answer(HTTPStatus.OK, {"stopped": stopped}, origin)

    def _stop(self, asked: Asked) -> list[dict[str, object]]:
        known = [*self._benches.own, *self._benches.others]
        if asked.bench is not None and asked.bench not in known:
            raise RefusedError(HTTPStatus.NOT_FOUND, f"there is no bench '{asked.bench}'")
        stopped: list[dict[str, object]] = []
        for bench in known if asked.bench is None else [asked.bench]:
            line = self._tell_runs(bench, asked)
            stopped.append({"bench": bench, "run": line.run if line is not None else None})
            if bench in self._benches.own:
                self._pending[bench] = asked
                if bench not in self._being_latched or line is not None:
                    self._being_latched.add(bench)
                    self._latches.latch(bench, asked, Path(line.folder if line is not None else ""))
            else:
                self._report(bench, asked, line, latched=False)
        return stopped

    def _tell_runs(self, bench: str, asked: Asked) -> Line | None:
        """Have the run of a bench stopped; which it was."""
        found = None
        for descriptor, line in list(self._lines.items()):
            if line.bench == bench and self._write(descriptor, asked):
                found = line
        return found

    def _write(self, descriptor: int, asked: Asked) -> bool:
        message = EmergencyAsked(by=asked.by, origin=asked.origin, way=asked.way)
        try:
            os.write(descriptor, to_run(message))
        except BlockingIOError:
            return True  # it knows since long
        except OSError:
            return False
        return True

    def _ring(self, latched: Latched) -> None:
        self._latched.put(latched)
        self._hammer.send(b"!")

    def _take_latched(self) -> None:
        self._bell.recv(_AT_ONCE)
        while not self._latched.empty():
            one = self._latched.get()
            self._being_latched.discard(one.bench)
            if not one.problem:
                self._pending.pop(one.bench, None)
            if one.new or one.problem:
                self._reported.pop(one.bench, None)
            self._report(one.bench, one.asked, None, latched=not one.problem, problem=one.problem)

    def _report(
        self, bench: str, asked: Asked, line: Line | None, *, latched: bool, problem: str = ""
    ) -> None:
        """Say it to the service; of one and the same who asks again and again only once."""
        known_already = self._reported.setdefault(bench, set())
        one = asked.by, asked.origin
        if line is None and (one in known_already or len(known_already) >= _MOST_REPORTED):
            return
        known_already.add(one)
        self._tell(
            Stopped(
                bench=bench,
                by=asked.by,
                role=asked.role,
                origin=asked.origin,
                way=asked.way,
                at_s=asked.at_s,
                run=line.run if line is not None else None,
                latched=latched,
                problem=problem,
            )
        )

    def _tell(self, message: Message) -> None:
        try:
            self._control.send(to_line(message))
        except OSError as error:  # a service that does not read finds the latch
            logger.warning("the service does not hear: %s", error)

    def _hear(self) -> None:
        try:
            data, descriptors, _, _ = socket.recv_fds(self._control, _AT_ONCE, 64)
        except BlockingIOError:
            return
        except OSError:
            data, descriptors = b"", []
        self._descriptors += descriptors
        if not data:
            self._ended = True
            return
        self._unread += data
        *lines, self._unread = self._unread.split(b"\n")
        for line in lines:
            self._take(from_line(bytes(line)))

    def _take(self, message: Message) -> None:
        if isinstance(message, Benches):
            self._benches = message
            self._latches.know(message.own)
        elif isinstance(message, Owners):
            self._answering.owners = message.by_sha256
        elif isinstance(message, Reset):
            self._pending.pop(message.bench, None)
            self._reported.pop(message.bench, None)
        elif isinstance(message, Line):
            self._add(message, self._descriptors.pop(0))

    def _add(self, line: Line, descriptor: int) -> None:
        os.set_blocking(descriptor, False)
        self._lines[descriptor] = line
        if line.bench in self._pending:  # it was asked for just before this run began
            self._write(descriptor, self._pending[line.bench])
        # Nothing is ever read from it: what comes is that the run has ended.
        self._selector.register(descriptor, selectors.EVENT_READ, lambda: self._drop(descriptor))

    def _drop(self, descriptor: int) -> None:
        self._selector.unregister(descriptor)
        del self._lines[descriptor]
        os.close(descriptor)


def main() -> None:
    """Work with the descriptors and settings that the service gives as arguments."""
    control, listening, settings = sys.argv[1:4]
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)
    allow_all_descriptors()
    chosen = json.loads(settings)
    answering = Answering(frozenset(chosen["hosts"]), frozenset(chosen["proxies"]))
    post = StopPostProcess(
        socket.socket(fileno=int(control)), socket.socket(fileno=int(listening)), answering
    )
    post.work()


if __name__ == "__main__":
    main()
