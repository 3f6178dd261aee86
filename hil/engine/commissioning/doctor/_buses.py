"""A bus as it is heard: load, senders, errors, what its adapter says, and how the devices' clocks go."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from drivers import TICK_S, Finding, SampleAssembler, Samples, SampleSource, Stream, Wire
from drivers.bus_health import Link, link_of
from hil.core.errors import BenchError
from hil.core.result import StreamClock
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


_RATE_WITHIN = 0.05  # share by which samples may come more often or more seldom than they should
_LATE_S = 0.02  # the RMCU waits 50 ms for the host


class Listener:
    """Takes the samples of every source, counts them and fits their clocks."""

    def __init__(self, sources: Sequence[SampleSource]) -> None:
        self._sources = sources
        self._streams = [stream for source in sources for stream in source.streams]
        self._taken: list[Samples] = []
        self._counts = dict.fromkeys(self._streams, 0)

    def take(self) -> None:
        """What has come since the last call."""
        for source in self._sources:
            for samples in source.samples():
                self._counts[samples.stream] += len(samples.time_s)
                self._taken.append(samples)

    def forget(self) -> None:
        """Let go of what has come until now."""
        for source in self._sources:
            list(source.samples())

    def clocks(self) -> tuple[list[StreamClock], list[Finding]]:
        """The clock of each counted stream that came; the first is what the others are compared with."""
        present = [stream for stream in self._streams if self._counts[stream]]
        if not present:
            return [], []
        assembler = SampleAssembler(list(_with_counters(present)), TICK_S)
        for samples in self._taken:
            assembler.add(samples)
        assembler.rows(everything=True)
        found = [
            StreamClock(
                stream=timing.stream.label,
                where=timing.stream.where,
                counted_by=timing.stream.counting.by if timing.stream.counting else "its own frames",
                offset_s=round(timing.offset_s, 6) + 0.0,
                drift_ppm=round(timing.drift_ppm, 1) + 0.0,
                latest_s=round(timing.latest_s, 6),
                lost=timing.lost,
                left_out=timing.left_out,
            )
            for timing in assembler.timings()
        ]
        return found, [*_parted(assembler), *_late(found)]

    def means(self) -> dict[str, float]:
        """Mean of each channel that came, where every value is known."""
        found: dict[str, float] = {}
        for stream in self._streams:
            values = [samples.values for samples in self._taken if samples.stream is stream]
            if values:
                means = np.concatenate(values).mean(axis=0)
                found |= dict(zip(stream.channels, means.tolist(), strict=True))
        return {name: mean for name, mean in found.items() if np.isfinite(mean)}

    def findings_of_rates(self, duration_s: float) -> Iterator[Finding]:
        """Streams that come more often or more seldom than they should."""
        for stream, count in self._counts.items():
            expected = duration_s / stream.period_s
            if count and abs(count - expected) > max(2.0, _RATE_WITHIN * expected):
                what = (
                    f"{stream.label} comes {count / duration_s:.4g} times a second, "
                    f"{1 / stream.period_s:.4g} are expected"
                )
                fix = "check the device's cycle time, the load of the bus, and whether frames are lost"
                yield Finding("fault", what, stream.where, fix)


def _with_counters(streams: Iterable[Stream]) -> Iterator[Stream]:
    """The streams, and what counts them, each once."""
    seen: set[Stream] = set()
    for stream in streams:
        counter = stream.counting.follows if stream.counting else None
        for one in (stream, *([counter] if counter else [])):
            if one not in seen:
                seen.add(one)
                yield one


def _parted(assembler: SampleAssembler) -> Iterator[Finding]:
    try:
        assembler.look_for_parted_clocks()
    except BenchError as error:
        yield Finding.of(error)


def _late(clocks: Iterable[StreamClock]) -> Iterator[Finding]:
    for clock in clocks:
        if clock.lost:
            fix = "check the adapter's receive buffer and the load of this machine"
            yield Finding("fault", f"{clock.lost} samples of {clock.stream} are lost", clock.where, fix)
        if clock.latest_s > _LATE_S:
            what = f"{clock.stream} arrived up to {clock.latest_s * 1e3:.0f} ms late"
            fix = "close other programs, use another USB port; see docs/explanation/time.md"
            yield Finding("hint", what, clock.where, fix)
