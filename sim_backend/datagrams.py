"""Frames of a CAN bus in UDP datagrams, between processes of one machine.

A datagram is a head (magic, version, kind, number of frames, sequence number of its first frame, counted for
each direction by itself) and then frames as `hil.core.can.frames.FRAME` lays them out, their stamps in
seconds since 1970. The hub's welcome carries the bit rate and the time scale in place of frames.
Little-endian throughout.
"""

from __future__ import annotations

import ipaddress
import struct
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from hil.core.can.frames import FRAME, FrameBlock

LOOPBACK = "127.0.0.1"
LARGEST = 1 << 16
_MAGIC, _VERSION = b"HILB", 1
_HEAD = struct.Struct("<4sBBHI")
_WELCOME = struct.Struct("<Id")
_MOST_FRAMES = 1000
_COUNTED = 1 << 32


class Kind(IntEnum):
    """What a datagram is."""

    HELLO = 1  # a host takes part, or still does
    WELCOME = 2  # the hub's answer
    FRAMES = 3
    BYE = 4  # either side leaves
    ECHO = 5  # a host takes part, or still does, and wants its own frames back


@dataclass(frozen=True)
class Welcome:
    """What a hub says of its bus."""

    bit_rate: int
    time_scale: float

    def packed(self) -> bytes:
        """As a datagram."""
        return signal(Kind.WELCOME) + _WELCOME.pack(self.bit_rate, self.time_scale)


class Outgoing:
    """One direction of one connection, at its sending end."""

    def __init__(self) -> None:
        self._next = 0

    def packed(self, block: FrameBlock) -> list[bytes]:
        """The frames as datagrams; what is not sent from here on is missed at the other end."""
        datagrams = []
        for first in range(0, len(block), _MOST_FRAMES):
            part = block[first : first + _MOST_FRAMES]
            datagrams.append(
                _HEAD.pack(_MAGIC, _VERSION, Kind.FRAMES, len(part), self._next) + part.tobytes()
            )
            self._next = (self._next + len(part)) % _COUNTED
        return datagrams

    def skip(self, frames: int) -> None:
        """Leave out some frames; the other end counts them as lost."""
        self._next = (self._next + frames) % _COUNTED


class Incoming:
    """One direction of one connection, at its receiving end; `lost` counts frames that never came."""

    def __init__(self) -> None:
        self._expected: int | None = None
        self.lost = 0

    def frames(self, datagram: bytes) -> FrameBlock:
        """The frames of a datagram; none if it is older than one that came before."""
        number, block = _frames_of(datagram)
        ahead = 0 if self._expected is None else (number - self._expected) % _COUNTED
        if ahead > _COUNTED // 2:
            return block[:0]
        self.lost += ahead
        self._expected = (number + len(block)) % _COUNTED
        return block


def signal(kind: Kind) -> bytes:
    """A datagram without frames."""
    return _HEAD.pack(_MAGIC, _VERSION, kind, 0, 0)


def kind_of(datagram: bytes) -> Kind | None:
    """What a datagram is; None for whatever is none of ours."""
    if len(datagram) < _HEAD.size:
        return None
    magic, version, kind, count, _ = _HEAD.unpack_from(datagram)
    if magic != _MAGIC or version != _VERSION or kind not in Kind.__members__.values():
        return None
    if kind == Kind.FRAMES and len(datagram) != _HEAD.size + count * FRAME.itemsize:
        return None
    if kind == Kind.WELCOME and len(datagram) != _HEAD.size + _WELCOME.size:
        return None
    return Kind(kind)


def welcome_of(datagram: bytes) -> Welcome:
    """What a hub says of its bus."""
    return Welcome(*_WELCOME.unpack_from(datagram, _HEAD.size))


def address_of(channel: str) -> tuple[str, int]:
    """Host and port of "127.0.0.1:47110"; nothing beyond this machine is ever spoken to.

    Raises:
        ValueError: another host, or no port.
    """
    host, _, port = channel.rpartition(":")
    host = LOOPBACK if host == "localhost" else host
    try:
        loopback = ipaddress.ip_address(host).is_loopback and ":" not in host
        number = int(port)
    except ValueError:
        loopback, number = False, 0
    if not loopback or not 0 < number < 1 << 16:
        raise ValueError(f"'{channel}' is not an address on this machine; write \"{LOOPBACK}:47110\"")
    return host, number


def _frames_of(datagram: bytes) -> tuple[int, FrameBlock]:
    *_, count, number = _HEAD.unpack_from(datagram)
    return number, np.frombuffer(datagram, FRAME, count, _HEAD.size).copy()
