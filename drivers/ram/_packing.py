"""How symbols are laid into ODTs: the packets in which a slave sends what it measured at one moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hil.core.can.frames import most_frame_bits
from hil.core.can.symbols import Symbol
from hil.core.can.xcp import LARGEST_ODT_NUMBER
from hil.core.errors import BenchError

_NUMBER_BYTES = 1


@dataclass(frozen=True)
class Entry:
    """Bytes of memory that stand together in an ODT."""

    address: int
    extension: int
    size: int


Odt = tuple[Entry, ...]


def packed(
    symbols: Sequence[Symbol], stamp_bytes: int, packet_bytes: int, granularity: int, most_in_entry: int
) -> list[Odt]:
    """The symbols byte behind byte, in as few packets as hold them; one may end in the next packet.

    Args:
        stamp_bytes: of the time stamp, which stands in the first packet.
        packet_bytes: of a packet, the ODT's number included.
        granularity: bytes of which the size of an entry is a multiple.
        most_in_entry: bytes of the largest entry.

    Raises:
        BenchError: a symbol whose size is no multiple, or more packets than there are numbers.
    """
    odts: list[list[Entry]] = [[]]
    room = packet_bytes - _NUMBER_BYTES - stamp_bytes
    for symbol in symbols:
        if symbol.size % granularity:
            raise BenchError(
                f"symbol '{symbol.name}' has {symbol.size} bytes; only multiples of {granularity} go"
            )
        address, left = symbol.address, symbol.size
        while left:
            size = min(left, room, most_in_entry) // granularity * granularity
            if not size:
                if not odts[-1] and len(odts) > 1:
                    raise BenchError(f"packets of {packet_bytes} bytes have no room for {granularity} bytes")
                odts.append([])
                room = packet_bytes - _NUMBER_BYTES
                continue
            odts[-1].append(Entry(address, symbol.extension, size))
            address, left, room = address + size, left - size, room - size
    if len(odts) > LARGEST_ODT_NUMBER:
        raise BenchError(f"{len(odts)} packets are needed for each sample; omit symbols")
    return [tuple(odt) for odt in odts]


def bits_of(odts: Sequence[Odt], stamp_bytes: int) -> int:
    """Bits that the packets of one moment take on a CAN bus, with as many stuff bits as there may be."""
    sizes = [_NUMBER_BYTES + sum(entry.size for entry in odt) for odt in odts]
    sizes[0] += stamp_bytes
    return sum(int(most_frame_bits(size, False)) for size in sizes)
