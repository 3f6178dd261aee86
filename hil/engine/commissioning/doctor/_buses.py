"""A bus as it is heard: load, who sends, errors, and what the adapter says of itself."""

from __future__ import annotations

from collections.abc import Iterator

from drivers import Finding, Wire
from drivers.linux_links import Link, link_of
from hil.engine.bench.bench_tables import Bus
from hil.engine.bench.bus_tally import Tally
from hil.engine.commissioning.doctor.examination import BusFacts

_FULL = 0.8  # above this share of the time frames with high identifiers begin to wait for long
_MANY_UNKNOWN = 8
_RATE_FIX = (
    "compare the bit rate of all nodes; check the cable and its terminators (120 ohm at both ends), and "
    "that the devices are powered"
)


def findings_of_bus(
    name: str, facts: BusFacts, tally: Tally, wire: Wire, *, expected: bool = True
) -> Iterator[Finding]:
    """What is wrong with an open bus; `expected`: whether anybody on it sends unasked."""
    where = f"bus '{name}'"
    if tally.frames == 0 and (expected or tally.errors):
        errors = f" but {tally.errors} error frames" if tally.errors else ""
        what = f"no frame received{errors}; the bench file says {facts.bit_rate} bit/s"
        yield Finding("fault", what, where, _RATE_FIX)
    elif tally.errors:
        yield Finding("fault", f"{tally.errors} error frames received", where, _RATE_FIX)
    if facts.load is not None and facts.load > _FULL:
        fix = "reduce the traffic on this bus, or raise its bit rate"
        yield Finding("hint", f"bus load is {facts.load:.0%}: frames are delayed", where, fix)
    if facts.unknown and tally.frames:
        shown = ", ".join(
            f"{number} ({rate:g}/s)" for number, rate in list(facts.unknown.items())[:_MANY_UNKNOWN]
        )
        more = f" and {len(facts.unknown) - _MANY_UNKNOWN} more" if len(facts.unknown) > _MANY_UNKNOWN else ""
        fix = "if they are from a device of the bench, correct its DBC, EDS or node id"
        yield Finding("hint", f"frames of no device in the bench file: {shown}{more}", where, fix)
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
        yield Finding("fault", "the network interface is down", where, f"bring it up with '{up}'")
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
