"""What may hold up a service, each until it is ended: half-open connections, hostile files, locks.

`python -m tests.hil.service.attacks half-open HOST:PORT COUNT`: connections in a process of its own, which
has descriptors enough.
"""

from __future__ import annotations

import contextlib
import resource
import socket
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from urllib.parse import urlsplit

from tests.hil.service.served import RefusedError, Served

#: A key of 40,000 parts, and a plan of 240 kB that is no plan.
DOTTED = ".".join(["a"] * 40_000) + " = 1\n"
LONG_PLAN = "name: long\nsteps:\n" + "  - wait: {duration_s: 1}\n" * 9_600
_HELD_S = 8.0  # how long a database is locked at a time: not long enough to be away for good

Attack = Callable[[Served], contextlib.AbstractContextManager[object]]


@contextlib.contextmanager
def half_open(service: Served, count: int = 1100, at: str = "") -> Iterator[subprocess.Popen[str]]:
    """So many connections whose heads never end; one that is closed is opened again at once."""
    place = urlsplit(at or service.url).netloc
    command = [sys.executable, "-m", __name__, "half-open", place, str(count)]
    attacker = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert attacker.stdout is not None
        assert attacker.stdout.readline() == "on\n"
        yield attacker
    finally:
        attacker.kill()
        attacker.communicate()


@contextlib.contextmanager
def hostile_model(service: Served) -> Iterator[None]:
    """An engineer puts a model of which one key has 40,000 parts, again and again."""
    with _again_and_again(lambda: service.ask("PUT", "/api/v1/models/dotted", DOTTED)):
        yield


@contextlib.contextmanager
def hostile_plan(service: Served) -> Iterator[None]:
    """An engineer puts a plan of 240 kB, again and again."""
    with _again_and_again(lambda: service.ask("PUT", "/api/v1/plans/long", LONG_PLAN)):
        yield


@contextlib.contextmanager
def locked_database(service: Served) -> Iterator[None]:
    """Somebody writes to the service's SQLite and does not end; pages ask for what is in it meanwhile."""
    ended = threading.Event()

    def lock() -> None:
        connection = sqlite3.connect(service.data / "service.sqlite", timeout=30.0, isolation_level=None)
        while not ended.is_set():
            connection.execute("BEGIN EXCLUSIVE")
            ended.wait(_HELD_S)
            connection.execute("ROLLBACK")
            ended.wait(0.2)
        connection.close()

    thread = threading.Thread(target=lock)
    thread.start()
    try:
        with _again_and_again(lambda: service.post("/runs", {"plan": "attacked", "bench": "bench"})):
            time.sleep(1.0)  # the first of these waits for the lock now
            yield
    finally:
        ended.set()
        thread.join()


@contextlib.contextmanager
def _again_and_again(work: Callable[[], object]) -> Iterator[None]:
    ended = threading.Event()

    def attack() -> None:
        while not ended.is_set():
            with contextlib.suppress(RefusedError, OSError):
                work()
            ended.wait(0.02)

    thread = threading.Thread(target=attack, daemon=True)
    thread.start()
    time.sleep(0.5)
    try:
        yield
    finally:
        ended.set()
        thread.join(40)


def _hold_half_open(place: str, count: int) -> None:
    limit = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(limit, count + 100), limit))
    host, _, port = place.rpartition(":")
    held: list[socket.socket] = []
    shown = False
    while True:
        while len(held) < count:
            with contextlib.suppress(OSError):
                one = socket.create_connection((host, int(port)), timeout=2.0)
                one.setblocking(False)
                one.sendall(b"GET /api/v1/health HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Never: ")
                held.append(one)
        if not shown:
            print("on", flush=True)
            shown = True
        time.sleep(0.05)
        held = [one for one in held if _is_open(one)]


def _is_open(one: socket.socket) -> bool:
    try:
        alive = bool(one.recv(1))
    except BlockingIOError:
        return True
    except OSError:
        alive = False
    if not alive:
        one.close()
    return alive


if __name__ == "__main__":
    _hold_half_open(sys.argv[2], int(sys.argv[3]))
