"""A CAN bus as a UDP port of this machine: every host that says hello takes part."""

from __future__ import annotations

import contextlib
import socket
import time
from typing import Any

import numpy as np

from hil.core.can.frames import SENT_BY_HOST, FrameBlock
from sim_backend.datagrams import LARGEST, LOOPBACK, Incoming, Kind, Outgoing, Welcome, kind_of, signal

_SILENT_S = 5.0  # hosts say hello every half a second; one that does not has left without a word, or is busy
_BUFFER_BYTES = 4 << 20


class _Host:
    def __init__(self) -> None:
        self.outgoing, self.incoming = Outgoing(), Incoming()
        self.heard_s = time.monotonic()
        self.wants_echo = False


class UdpHub:
    """One bus; hosts hear the bench and each other, and themselves if they ask for it.

    Args:
        port: 0 takes a free one.

    Raises:
        OSError: the port is taken.
    """

    def __init__(self, port: int, bit_rate: int, time_scale: float) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((LOOPBACK, port))
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)
        for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            self._socket.setsockopt(socket.SOL_SOCKET, option, _BUFFER_BYTES)
        self._welcome = Welcome(bit_rate, time_scale).packed()
        self._hosts: dict[tuple[str, int], _Host] = {}
        self._lost_before = 0  # by hosts that have left

    @property
    def table(self) -> dict[str, Any]:
        """What a bench file says to reach it."""
        return {"interface": "hil-udp", "channel": f"{LOOPBACK}:{self._socket.getsockname()[1]}"}

    @property
    def lost(self) -> int:
        """Frames that hosts sent and that never came."""
        return self._lost_before + sum(host.incoming.lost for host in self._hosts.values())

    def take(self) -> list[tuple[float | None, int, bytes]]:
        """Frames of hosts since the last call: when they were sent, identifier and data."""
        frames: list[tuple[float | None, int, bytes]] = []
        while True:
            try:
                datagram, address = self._socket.recvfrom(LARGEST)
            except BlockingIOError:
                return frames
            except OSError:
                continue  # a host that is gone; it will be silent
            block = self._heard(datagram, address)
            if block is not None:
                frames += _plain(block)

    def _heard(self, datagram: bytes, address: tuple[str, int]) -> FrameBlock | None:
        """The frames of a host that takes part."""
        kind = kind_of(datagram)
        if kind is Kind.HELLO or kind is Kind.ECHO:
            host = self._hosts.setdefault(address, _Host())
            host.heard_s, host.wants_echo = time.monotonic(), kind is Kind.ECHO
            self._send(self._welcome, address)
        elif kind is Kind.BYE:
            self._forget(address)
        elif kind is Kind.FRAMES and address in self._hosts:
            host = self._hosts[address]
            host.heard_s = time.monotonic()
            block = host.incoming.frames(datagram)
            self._spread(block, besides=address)
            if host.wants_echo and len(block):
                self._echo(block, host, address)
            return block
        return None

    def give(self, block: FrameBlock) -> None:
        """Frames of the bench to every host; stamps in seconds since 1970."""
        self._spread(block)

    def close(self) -> None:
        """Let every host know, and leave."""
        for address in self._hosts:
            self._send(signal(Kind.BYE), address)
        self._socket.close()

    def _spread(self, block: FrameBlock, besides: tuple[str, int] | None = None) -> None:
        now_s = time.monotonic()
        for address, host in self._hosts.items():
            if now_s - host.heard_s > _SILENT_S:
                host.outgoing.skip(len(block))  # it may be busy, and will know by the numbers what it missed
            elif address != besides:
                for datagram in host.outgoing.packed(block):
                    self._send(datagram, address)

    def _echo(self, block: FrameBlock, host: _Host, address: tuple[str, int]) -> None:
        """A host's frames as they were on the bus: at the time at which they came."""
        shown = block.copy()
        shown["flags"] |= SENT_BY_HOST
        shown["time_s"] = time.time()
        for datagram in host.outgoing.packed(shown):
            self._send(datagram, address)

    def _send(self, datagram: bytes, address: tuple[str, int]) -> None:
        with contextlib.suppress(OSError):  # the host misses it by its number
            self._socket.sendto(datagram, address)

    def _forget(self, address: tuple[str, int]) -> None:
        host = self._hosts.pop(address, None)
        if host is not None:
            self._lost_before += host.incoming.lost


def _plain(block: np.ndarray[Any, Any]) -> list[tuple[float | None, int, bytes]]:
    return [
        (stamp, identifier, data.to_bytes(8, "little")[:length])
        for stamp, identifier, flags, length, data in zip(
            block["time_s"].tolist(),
            block["id"].tolist(),
            block["flags"].tolist(),
            block["length"].tolist(),
            block["data"].tolist(),
            strict=True,
        )
        if not flags
    ]
