"""A CAN bus as socketcand serves it, on a TCP port of this machine: the raw mode of its protocol."""

from __future__ import annotations

import contextlib
import socket
import time
from typing import Any

import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, FrameBlock
from sim_backend.datagrams import LOOPBACK

_READ = 65536
_MOST_WAITING = 1 << 20  # bytes
_LONGEST_ORDER = 200
_QUIET_S = (
    0.1  # before the first frame: python-can takes what comes along with the last answer for the answer
)


class SocketcandPort:
    """One bus under a name; any number of hosts.

    Args:
        port: 0 takes a free one.
        name: what hosts open.

    Raises:
        OSError: the port is taken.
    """

    def __init__(self, port: int, name: str) -> None:
        self._listening = socket.create_server((LOOPBACK, port))
        self._listening.setblocking(False)
        self._name = name
        self._hosts: list[_Host] = []
        self._lost_before = 0

    @property
    def table(self) -> dict[str, Any]:
        """What a bench file says to reach it."""
        port = self._listening.getsockname()[1]
        options = {"host": LOOPBACK, "port": port, "tcp_tune": True}
        return {"interface": "socketcand", "channel": self._name, "options": options}

    @property
    def lost(self) -> int:
        """Frames of the bench that a host did not fetch."""
        return self._lost_before + sum(host.lost for host in self._hosts)

    def take(self) -> list[tuple[float | None, int, bytes]]:
        """Frames of hosts since the last call: identifier and data; when they were sent does not pass."""
        with contextlib.suppress(BlockingIOError):
            while True:
                connection, _ = self._listening.accept()
                self._hosts.append(_Host(connection, self._name))
        frames: list[tuple[float | None, int, bytes]] = []
        for host in self._hosts:
            frames += [(None, *frame) for frame in host.take()]
        for host in [host for host in self._hosts if host.gone]:
            self._hosts.remove(host)
            self._lost_before += host.lost
            host.close()
        return frames

    def give(self, block: FrameBlock) -> None:
        """Frames of the bench to every host, with their stamps."""
        lines = [host for host in self._hosts if host.raw]
        if lines:
            text = _orders(block)
            for host in lines:
                host.put(text, len(block))

    def close(self) -> None:
        """Hang up."""
        for host in self._hosts:
            host.close()
        self._listening.close()


class _Host:
    """One connection."""

    def __init__(self, connection: socket.socket, name: str) -> None:
        self._connection, self._name = connection, name
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._heard, self._waiting = b"", b""
        self._opened = self.gone = False
        self._raw_s = float("inf")
        self.lost = 0
        self.put(b"< hi >")

    def take(self) -> list[tuple[int, bytes]]:
        """Frames that it sent."""
        try:
            while True:
                data = self._connection.recv(_READ)
                if not data:
                    self.gone = True
                    break
                self._heard += data
        except BlockingIOError:
            pass
        except OSError:
            self.gone = True
        *orders, self._heard = self._heard.split(b">")
        self._heard = self._heard[-_LONGEST_ORDER:]
        frames = []
        for order in orders:
            frame = self._obey(order.decode("ascii", "replace").partition("<")[2].split())
            if frame is not None:
                frames.append(frame)
        return frames

    @property
    def raw(self) -> bool:
        """Whether it hears frames by now."""
        return time.monotonic() >= self._raw_s

    def put(self, text: bytes, frames: int = 0) -> None:
        """Send, now or when it fetches."""
        if len(self._waiting) > _MOST_WAITING:
            self.lost += frames
            return
        self._waiting += text
        with contextlib.suppress(OSError):  # it is full, or gone: then that is seen when it is listened to
            self._waiting = self._waiting[self._connection.send(self._waiting) :]

    def close(self) -> None:
        """Hang up."""
        self._connection.close()

    def _obey(self, words: list[str]) -> tuple[int, bytes] | None:
        if words[:1] == ["send"] and self._opened:
            return _frame(words)
        if words[:1] == ["open"]:
            self._opened = words[1:] == [self._name]
            self.put(b"< ok >" if self._opened else b"< error could not open bus >")
        elif words == ["rawmode"] and self._opened:
            self.put(b"< ok >")
            self._raw_s = time.monotonic() + _QUIET_S
        elif words == ["echo"]:
            self.put(b"< echo >")
        elif words:
            self.put(b"< error unknown command >")
        return None


def _frame(words: list[str]) -> tuple[int, bytes] | None:
    """A standard data frame; the devices of the bench hear no other."""
    try:
        identifier, length = words[1], int(words[2], 16)
        data = bytes(int(word, 16) for word in words[3:])
        return (int(identifier, 16), data) if len(identifier) == 3 and len(data) == length else None
    except (ValueError, IndexError):
        return None


def _orders(block: np.ndarray[Any, Any]) -> bytes:
    columns = (block[name].tolist() for name in ("time_s", "id", "flags", "length", "data"))
    return b"".join(
        b"< error %08X %.6f >" % (identifier, stamp)
        if flags & ERROR_FRAME
        else b"< frame %0*X %.6f %s >"
        % (
            8 if flags & EXTENDED else 3,
            identifier,
            stamp,
            data.to_bytes(8, "little")[:length].hex().upper().encode(),
        )
        for stamp, identifier, flags, length, data in zip(*columns, strict=True)
    )
