"""A bus as it is heard: load, who sends, errors, and what the adapter says of itself."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from drivers import Finding, Wire, bits_on_the_wire
from drivers.linux_links import Link, link_of
from hil.core.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.engine.bench_tables import BenchFile, Bus
from hil.engine.doctor.examination import BusFacts

_FULL = 0.8  # above this share of the time frames with high identifiers begin to wait for long
_MANY_UNKNOWN = 8
_RATE_FIX = (
    "compare the bit rate of all nodes; check the cable and its terminators (120 ohm at both ends), and "
    "that the devices are powered"
)


class Tally:
    """Counts what is heard on one bus."""

    def __init__(self) -> None:
        self._counts: dict[tuple[int, bool], int] = {}
        self._bits = 0
        self.errors = 0
        self.sent_by_hosts: set[int] = set()

    def take(self, block: FrameBlock) -> None:
        """Count the frames of one bus."""
        self._bits += int(bits_on_the_wire(block).sum())
        errors = block["flags"] & ERROR_FRAME != 0
        self.errors += int(np.count_nonzero(errors))
        others = block[~errors & (block["flags"] & SENT_BY_HOST == 0)]
        numbers, counts = np.unique(others["id"] << 1 | others["flags"] & EXTENDED, return_counts=True)
        for number, count in zip(numbers.tolist(), counts.tolist(), strict=True):
            key = (number >> 1, bool(number & 1))
            self._counts[key] = self._counts.get(key, 0) + count

    @property
    def frames(self) -> int:
        """Data frames of others so far."""
        return sum(self._counts.values())

    @property
    def standard_ids(self) -> set[int]:
        """Identifiers of 11 bits that others sent."""
        return {number for number, extended in self._counts if not extended}

    def describe(self, facts: BusFacts, known: Collection[int], duration_s: float) -> None:
        """Fill in what was heard in `duration_s` seconds."""
        facts.load = round(self._bits / facts.bit_rate / duration_s, 4)
        facts.frames_s = round(self.frames / duration_s, 1)
        facts.error_frames = self.errors
        facts.unknown = {
            f"0x{number:08X}" if extended else f"0x{number:03X}": round(count / duration_s, 1)
            for (number, extended), count in sorted(self._counts.items())
            if extended or number not in known
        }


def known_identifiers(file: BenchFile, bus: str) -> set[int]:
    """What the devices of a bench file send or hear on a bus."""
    tables = [table for table in file.device_tables.values() if getattr(table, "bus", None) == bus]
    return {number for table in tables for number in table.identifiers()}


def findings_of_bus(name: str, facts: BusFacts, tally: Tally, wire: Wire) -> Iterator[Finding]:
    """What is wrong with an open bus."""
    where = f"bus '{name}'"
    if tally.frames == 0:
        errors = f" but {tally.errors} error frames" if tally.errors else ""
        what = f"not one frame came{errors}; the bench file says {facts.bit_rate} bit/s"
        yield Finding("fault", what, where, _RATE_FIX)
    elif tally.errors:
        yield Finding("fault", f"{tally.errors} error frames came", where, _RATE_FIX)
    if facts.load is not None and facts.load > _FULL:
        fix = "take other traffic off this bus, or raise its bit rate"
        yield Finding(
            "hint", f"it is busy {facts.load:.0%} of the time: frames wait for each other", where, fix
        )
    if facts.unknown and tally.frames:
        shown = ", ".join(
            f"{number} ({rate:g}/s)" for number, rate in list(facts.unknown.items())[:_MANY_UNKNOWN]
        )
        more = f" and {len(facts.unknown) - _MANY_UNKNOWN} more" if len(facts.unknown) > _MANY_UNKNOWN else ""
        fix = "if a device of the bench should have sent them, correct its DBC, EDS or node id"
        yield Finding("hint", f"frames that no device of the bench file has: {shown}{more}", where, fix)
    for remark in wire.remarks:
        if "error frames" not in remark:
            yield Finding("hint", remark, where, "see docs/reference/transports.md")


def findings_of_link(name: str, bus: Bus, facts: BusFacts) -> Iterator[Finding]:
    """What Linux says of a SocketCAN interface; also when it could not be opened."""
    if bus.interface != "socketcan":
        return
    link = link_of(str(bus.channel))
    if link is None:
        return
    facts.controller = {key: value for key, value in vars(link).items() if value not in (None, "")}
    yield from judged(name, bus, link)


def judged(name: str, bus: Bus, link: Link) -> Iterator[Finding]:
    """What is wrong with a SocketCAN interface."""
    where = f"bus '{name}' (socketcan {bus.channel})"
    up = f"ip link set {bus.channel} up type can bitrate {bus.bit_rate}"
    if not link.up:
        yield Finding("fault", "the network interface is down", where, f"'{up}' brings it up")
    elif link.bit_rate is not None and link.bit_rate != bus.bit_rate:
        what = f"the interface runs at {link.bit_rate} bit/s, the bench file says {bus.bit_rate}"
        fix = f"'ip link set {bus.channel} down', then '{up}'; or correct bit_rate in the bench file"
        yield Finding("fault", what, where, fix)
    if link.state and link.state not in ("ERROR-ACTIVE", "STOPPED"):
        counters = f" (error counters: transmit {link.transmit_errors}, receive {link.receive_errors})"
        yield Finding("fault", f"the controller is in {link.state}{counters}", where, _RATE_FIX)
    elif link.transmit_errors or link.receive_errors:
        what = f"error counters: transmit {link.transmit_errors}, receive {link.receive_errors}"
        yield Finding("hint", what, where, _RATE_FIX)
    if link.listen_only:
        fix = f"'ip link set {bus.channel} down', then '{up} listen-only off'"
        yield Finding("fault", "the interface only listens: nothing can be sent", where, fix)
    if link.dropped:
        what = f"the kernel has dropped {link.dropped} received frames since the interface was made"
        yield Finding("hint", what, where, "raise net.core.rmem_max")
