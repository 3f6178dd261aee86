"""Connections whose request does not come are closed, and give way before they are too many."""

from __future__ import annotations

import socket
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.hil.service.served import SHORT, Served, served

HEAD = b"POST /api/v1/session HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
#: What a service with 128 descriptors gives one address: three quarters of the half of them.
MOST_OF_ONE = 48


@pytest.mark.slow
def test_a_head_that_never_ends_is_not_waited_for_and_one_that_comes_in_pieces_is(service: Served) -> None:
    with _opened(service) as silent, _opened(service) as half:
        half.sendall(HEAD)
        assert silent.recv(1) == b""
        assert half.recv(1) == b""
    with _opened(service) as slow:
        slow.sendall(HEAD)
        slow.sendall(b"Content-Length: 2\r\n\r\n{")
        slow.sendall(b"}")
        assert slow.recv(12) == b"HTTP/1.1 422"


@pytest.mark.slow
def test_of_too_many_the_longest_silent_gives_way_and_who_asks_is_answered(tmp_path: Path) -> None:
    limited = ("sh", "-c", 'ulimit -n 128; exec "$@"', "sh")
    with served(tmp_path / "data", state=tmp_path / "state", through=limited) as service:
        held = [_opened(service) for _ in range(2 * MOST_OF_ONE)]
        try:
            for one in held:
                one.sendall(HEAD)
            assert service.get("/health")["status"] == "ok"
            assert _is_closed(held[0])
            assert not _is_closed(held[-1])
            service.give("short", SHORT)
            run = service.over(service.queue())
            assert run["exit_code"] == 0  # descriptors are left for runs
        finally:
            for one in held:
                one.close()


def _opened(service: Served) -> socket.socket:
    where = urlsplit(service.url)
    return socket.create_connection((where.hostname or "", where.port or 0), timeout=60)


def _is_closed(one: socket.socket) -> bool:
    one.settimeout(2.0)
    try:
        return one.recv(1) == b""
    except TimeoutError:
        return False
    except OSError:
        return True
