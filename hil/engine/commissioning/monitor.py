"""Shows what goes on on a bench's buses and touches nothing: no frame is sent, not even a heartbeat."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from drivers import BusLoop, Device, MotorControl, Samples
from drivers.bus_health import link_of
from hil.core.can.frames import FrameBlock
from hil.core.errors import BadInputError, BenchError, InterruptError
from hil.core.errors.wording import printable
from hil.engine.bench.bench import bench_clock, connections_of, open_wire
from hil.engine.bench.bench_tables import BenchFile, Bus
from hil.engine.bench.bus_settings import listens_only
from hil.engine.bench.bus_tally import Tally, known_identifiers
from hil.engine.stop.stopping import StopRequest

_CHUNK_S = 0.05


@dataclass(frozen=True)
class BusView:
    """One bus over a stretch of time: share of it that was taken, frames and error frames a second."""

    load: float
    frames_s: float
    errors_s: float
    unknown: dict[str, float]


@dataclass(frozen=True)
class ChannelView:
    """One channel over a stretch of time; NaN where nothing came."""

    unit: str
    value: float
    lowest: float
    highest: float
    samples_s: float


@dataclass(frozen=True)
class View:
    """What was seen in the last `duration_s` seconds, `time_s` after the beginning."""

    time_s: float
    duration_s: float
    buses: dict[str, BusView]
    channels: dict[str, ChannelView]
    devices: dict[str, str]


@dataclass
class MonitorRequest:
    """A bench to be listened to.

    Attributes:
        every_s: seconds of the bench clock between two views.
        for_s: ends by itself after this many seconds.
        begin: called once with what is to be known beforehand, a sentence each.
        show: called with each view.
    """

    bench: BenchFile
    every_s: float = 0.5
    for_s: float = math.inf
    begin: Callable[[list[str]], None] = lambda notes: None
    show: Callable[[View], None] = lambda view: None
    stop: StopRequest = field(default_factory=StopRequest)


def monitor(request: MonitorRequest) -> View:
    """Listen until the time is over or somebody asks to stop; the view of the whole time.

    Raises:
        BadInputError: a bench that computes its buses: no one is on them but who computes them.
        BenchError: no bus can be opened, or one fails.
    """
    file = request.bench
    if file.simulation is not None:
        raise BadInputError(
            "is simulated: its buses exist only during a run, so there is nothing to monitor",
            where=printable(file.source, 200),
            fix="serve it with 'hil bench sim', and give the bench file that it prints",
        )
    for name, value in (("--every", request.every_s), ("--for", request.for_s)):
        if not value > 0:
            raise BadInputError(f"{name} is {value:g}", fix="give seconds greater than 0")
    with ExitStack() as opened:
        return _Monitor(request, opened).watch()


class _Monitor:
    def __init__(self, request: MonitorRequest, opened: ExitStack) -> None:
        self._request, self._file = request, request.bench
        self._notes: list[str] = []
        self._loop = self._open_buses(opened)
        connections = connections_of(self._file, self._loop)
        self._devices: dict[str, Device] = {}
        for key, table in self._file.device_tables.items():
            if getattr(table, "bus", None) in connections.wires:
                self._devices[key] = table.open(key.removeprefix("devices."), connections)
            elif getattr(table, "bus", None) is None:
                self._notes.append(f"{key} is not shown, because opening its port would affect it")

    def watch(self) -> View:
        request, loop = self._request, self._loop
        loop.run_for(_CHUNK_S)  # what came while all was opened tells no rates
        self._forget()
        request.begin(self._notes)
        loop.on_block(self._count)
        loop.on_drained(self._take)
        now, whole = self._stretch(), self._stretch()
        self._open_stretches = (now, whole)
        first_s = loop.clock.now_s()
        with request.stop.by_signals(), request.stop.telling(partial(setattr, loop, "stop_requested", True)):
            while loop.clock.now_s() - first_s < request.for_s:
                end_s = min(now.begin_s + request.every_s, first_s + request.for_s)
                try:
                    while loop.clock.now_s() < end_s:
                        loop.run_for(min(_CHUNK_S, max(0.001, end_s - loop.clock.now_s())))
                except InterruptError:
                    break
                request.show(now.view(first_s))
                now = self._stretch()
                self._open_stretches = (now, whole)
        return whole.view(first_s)

    def _open_buses(self, opened: ExitStack) -> BusLoop:
        clock, offset_s = bench_clock(self._file, None, opened)
        wires, failures = [], []
        for name, bus in self._file.buses.items():
            try:
                wires.append(open_wire(self._file, name, clock, offset_s, opened, listen_only=True))
                self._notes += _how_it_listens(name, bus)
            except BenchError as error:
                failures.append(error)
                self._notes.append(f"{error.where}: {error.what}")
        if not wires:
            raise failures[0]
        return BusLoop(clock, wires)

    def _stretch(self) -> _Stretch:
        return _Stretch(self._file, self._loop, self._devices)

    def _forget(self) -> None:
        for device in self._devices.values():
            for source in device.sources:
                list(source.samples())

    def _count(self, bus: str, block: FrameBlock) -> None:
        for stretch in self._open_stretches:
            stretch.tallies[bus].take(block)

    def _take(self) -> None:
        for device in self._devices.values():
            for source in device.sources:
                for samples in source.samples():
                    for stretch in self._open_stretches:
                        stretch.take(samples)


class _Stretch:
    """What came in a stretch of time."""

    def __init__(self, file: BenchFile, loop: BusLoop, devices: dict[str, Device]) -> None:
        self._file, self._loop, self._devices = file, loop, devices
        self.begin_s = loop.clock.now_s()
        self.tallies = {wire.name: Tally() for wire in loop.wires}
        streams = [
            stream for device in devices.values() for source in device.sources for stream in source.streams
        ]
        self._units = {
            name: unit for stream in streams for name, unit in zip(stream.channels, stream.units, strict=True)
        }
        self._seen: dict[str, tuple[float, float, float, int]] = {}

    def take(self, samples: Samples) -> None:
        """Remember the newest, the lowest and the highest value of each channel."""
        for column, name in enumerate(samples.stream.channels):
            values = samples.values[:, column]
            if not len(values):
                continue
            _, lowest, highest, count = self._seen.get(name, (math.nan, math.nan, math.nan, 0))
            low, high = float(np.fmin.reduce(values)), float(np.fmax.reduce(values))
            lowest, highest = float(np.fmin(lowest, low)), float(np.fmax(highest, high))
            self._seen[name] = float(values[-1]), lowest, highest, count + len(values)

    def view(self, first_s: float) -> View:
        """The stretch until now."""
        now_s = self._loop.clock.now_s()
        duration_s = max(now_s - self.begin_s, 1e-3)
        nothing = (math.nan, math.nan, math.nan, 0)
        buses = {
            name: BusView(
                tally.load(self._file.buses[name].bit_rate, duration_s),
                tally.frames / duration_s,
                tally.errors / duration_s,
                tally.unknown(known_identifiers(self._file, name), duration_s),
            )
            for name, tally in self.tallies.items()
        }
        channels = {}
        for name, unit in self._units.items():
            value, lowest, highest, count = self._seen.get(name, nothing)
            channels[name] = ChannelView(unit, value, lowest, highest, count / duration_s)
        devices = {key: _state_of(device) for key, device in self._devices.items()}
        return View(now_s - first_s, duration_s, buses, channels, devices)


def _state_of(device: Device) -> str:
    """What a device says of itself without being asked."""
    lines = list(dict.fromkeys(device.troubles()))
    if isinstance(device, MotorControl):
        lines = [device.state or "sends no status", *lines]
    return "; ".join(printable(text, 200) for text in lines) or "no trouble"


def _how_it_listens(name: str, bus: Bus) -> list[str]:
    """Whether the adapter acknowledges what it hears: then the bus is not quite as without it."""
    if listens_only(bus):
        return [f"bus '{name}': the adapter listens only"]
    if bus.interface == "socketcan":
        link = link_of(str(bus.channel))
        if link is not None and link.listen_only:
            return [f"bus '{name}': the controller listens only"]
        command = f"ip link set {printable(bus.channel, 20)} type can listen-only on"
        how = f"'{command}', while it is down, keeps it from that"
        return [f"bus '{name}': nothing is sent, but the controller acknowledges frames; {how}"]
    return [f"bus '{name}': nothing is sent"]
