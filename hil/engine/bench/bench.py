"""Opens a bench: buses, clock, devices; real or simulated by what the bench file says."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field, replace

from drivers import (
    BusHealth,
    BusLoop,
    Connections,
    Device,
    ListeningWire,
    MotorControl,
    SampleSource,
    Stream,
    VehicleParameters,
    WheelLoad,
    Wire,
    open_can,
)
from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError, BenchError
from hil.core.errors.wording import printable
from hil.core.model import Model, load_model
from hil.core.runtime.clock import Clock, WallClock, undisturbed
from hil.engine.bench.bench_channels import refuse_channels, who_is_missing
from hil.engine.bench.bench_lock import alone_on
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_settings import can_settings
from hil.engine.bench.computed_channels import Computed, computed_channels
from hil.engine.bench.request_timing import Periodic, RequestTiming
from hil.engine.bench.simulable import simulated
from sim_backend.bench import SimulatedBench
from sim_backend.can_interface import attach, detach
from sim_backend.rcs import EmulatedPanel, PanelPort

_LOG = logging.getLogger(__name__)
_SERIAL_S = 0.01  # what stands in at the other end of a serial line looks at it so often


@dataclass
class Bench:
    """An open bench.

    `further` are the devices beside the RMCU and the dynos, by name; `missing` those that cannot be opened,
    with why; `computed` gives channels that no device measures.
    """

    file: BenchFile
    loop: BusLoop
    rmcu: MotorControl
    dyno: WheelLoad
    model: Model | None
    further: dict[str, Device]
    missing: dict[str, str] = field(default_factory=dict)
    computed: list[Computed] = field(default_factory=list)

    @property
    def simulated(self) -> bool:
        """Whether there is no hardware."""
        return self.model is not None

    @property
    def devices(self) -> list[Device]:
        """All devices, in the order in which they come up."""
        return [self.rmcu, self.dyno, *self.further.values()]

    @property
    def devices_by_key(self) -> dict[str, Device]:
        """All devices by the keys of their tables in the bench file."""
        further = {f"devices.{name}": device for name, device in self.further.items()}
        return {"rmcu": self.rmcu, "dyno": self.dyno, **further}

    @property
    def sources(self) -> list[SampleSource]:
        """Whatever gives samples; what is computed from others' comes last."""
        return [*(source for device in self.devices for source in device.sources), *self.computed]

    @property
    def streams(self) -> list[Stream]:
        """What is sampled; the first is the time base of a recording."""
        return [stream for source in self.sources for stream in source.streams]

    def start_heartbeats(self, timing: RequestTiming | None = None) -> None:
        """Let every device that watches the host know from now on that it lives."""
        for key, device in self._by_key():
            period_s = device.heartbeat_s
            if period_s is not None:
                noted = timing.of(device, self._bus_of(key), "heartbeat", period_s) if timing else None
                self.loop.every(period_s, device.beat, noted.noted if noted else None)

    def torque_requests(self, timing: RequestTiming, period_s: float) -> Periodic:
        """What notes the cycles of torque requests."""
        return timing.of(self.rmcu, self._bus_of("rmcu"), "torque request", period_s)

    def _by_key(self) -> list[tuple[str, Device]]:
        further = [(f"devices.{name}", device) for name, device in self.further.items()]
        return [("rmcu", self.rmcu), ("dyno", self.dyno), *further]

    def _bus_of(self, key: str) -> str | None:
        """The CAN bus that a device is on; None if its table names none."""
        return getattr(self.file.device_tables.get(key), "bus", None)


@contextlib.contextmanager
def open_bench(file: BenchFile, *, model: Model | None = None) -> Iterator[Bench]:
    """Open every bus and every device; close all at the end.

    Args:
        model: takes the place of the bench file's model on a simulated bench.

    Raises:
        BadInputError: a file that the bench file names cannot be used, or devices that do not go together.
        BenchError: a bus or a port cannot be opened, or another process drives the bench.
    """
    if model is not None and not file.simulation:
        raise BadInputError(
            "--model goes with a simulated bench only", where=str(file.source), fix="leave --model out"
        )
    with ExitStack() as opened:
        if file.simulation:
            model = model or load_model(file.simulation.model)
        opened.enter_context(alone_on(file))
        clock, offset_s = bench_clock(file, model, opened)
        wires = {name: open_wire(file, name, clock, offset_s, opened) for name in file.buses}
        if not file.simulation:
            opened.enter_context(undisturbed(collections=True))
        connections = connections_of(file, BusLoop(clock, list(wires.values())), opened)
        for wire in wires.values():
            connections.loop.on_drained(wire.check)
        bench = _with_devices(file, connections, model, opened)
        refuse_channels(file, bench.streams, bench.missing)
        yield bench


def bench_clock(file: BenchFile, model: Model | None, opened: ExitStack) -> tuple[Clock, float]:
    """The clock of a bench, and the time since 1970 at which it began, in wall-clock seconds.

    With `model` the clock is that of a simulated bench, which can be reached from now on until `opened` is
    closed.
    """
    if model is not None:
        world = simulated(file, model)
        attach(file.name, world)
        opened.callback(detach, file.name)
        return world, 0.0
    clock = WallClock(file.time_scale)
    return clock, time.time() - clock.now_s() / file.time_scale


def open_wire(
    file: BenchFile, name: str, clock: Clock, offset_s: float, opened: ExitStack, *, listen_only: bool = False
) -> Wire:
    """Open a bus of the bench file; it is closed with `opened`.

    Args:
        listen_only: nothing can be sent; where the adapter can, it does not even acknowledge frames.

    Raises:
        BadInputError: the bench at the other end goes at another pace.
        BenchError: it cannot be opened.
    """
    bus, scale = file.buses[name], file.time_scale
    settings = can_settings(name, bus, listen_only=listen_only)
    adapter = open_can(settings)
    health = BusHealth(name, bus.interface, adapter)
    kind = ListeningWire if listen_only else Wire
    wire = kind(
        name,
        adapter,
        clock,
        epoch_offset_s=offset_s,
        time_scale=scale,
        health=health,
        echoing=settings.echoing,
    )
    opened.callback(wire.close)
    _refuse_other_pace(name, getattr(adapter, "time_scale", scale), scale)
    return wire


def connections_of(file: BenchFile, loop: BusLoop, opened: ExitStack | None = None) -> Connections:
    """What the devices of a bench file are opened with; the wires are those of the loop.

    With `opened`, where time is computed, devices on serial lines find stand-ins, which are closed with it.
    """
    v = file.vehicle
    vehicle = VehicleParameters(v.wheel_radius_m, v.slip, v.inertia_kg_m2, v.rolling_nm, v.aero_nms2_rad2)
    wires = {wire.name: wire for wire in loop.wires}
    connections = Connections(loop, wires, vehicle, simulated=file.simulation is not None)
    if opened is not None and isinstance(loop.clock, SimulatedBench):
        return _with_stand_ins(connections, loop.clock, opened)
    return connections


def _with_stand_ins(connections: Connections, world: SimulatedBench, opened: ExitStack) -> Connections:
    """Let devices on serial lines find what stands in for them, in the time of the simulated bench."""

    def panel() -> str:
        radius_m = connections.vehicle.wheel_radius_m
        port = PanelPort(
            EmulatedPanel(
                lambda vehicle: world.set_vehicle(vehicle.at_wheels(radius_m)), friction=world.has_friction
            )
        )
        opened.callback(port.close)
        connections.loop.every(_SERIAL_S, port.tick)
        return port.port

    return replace(connections, serial_stand_ins={"rcs-panel": panel})


def _refuse_other_pace(name: str, theirs: float, ours: float) -> None:
    if theirs != ours:
        raise BadInputError(
            f"the connected simulated bench runs at {theirs:g} of real time, the bench file says {ours:g}",
            where=f"bus '{name}'",
            fix=f"write time_scale = {theirs:g} at the top of the bench file",
        )


def _with_devices(file: BenchFile, connections: Connections, model: Model | None, opened: ExitStack) -> Bench:
    devices: dict[str, Device] = {}
    missing: dict[str, str] = {}
    for key, table in file.device_tables.items():
        name = key.removeprefix("devices.")
        try:
            device = devices[key] = table.open(name, connections)
        except BenchError as error:
            if key in ("rmcu", "dyno"):
                raise
            missing[name] = f"{error.where}: {error.what}" if error.where else error.what
            continue
        opened.callback(_close, device)
    rmcu, dyno = devices.pop("rmcu"), devices.pop("dyno")
    if not isinstance(rmcu, MotorControl):
        raise _wrong_place(file, "rmcu", "is not a motor device")
    if not isinstance(dyno, WheelLoad):
        raise _wrong_place(file, "dyno", "is not a dyno device")
    further = {key.removeprefix("devices."): device for key, device in devices.items()}
    computed = computed_channels(file, connections.loop)
    return Bench(file, connections.loop, rmcu, dyno, model, further, missing, computed)


def _close(device: Device) -> None:
    """Let go of a device; what goes wrong in that must not cost a run its outcome."""
    try:
        device.close()
    except Exception:
        _LOG.exception("%s cannot be closed", device.name)


def _wrong_place(file: BenchFile, key: str, what: str) -> BadInputError:
    kind = file.device_tables[key].kind
    return BadInputError(
        f"{key}.kind = '{printable(kind)}': {what}",
        where=printable(file.source, 200),
        fix="give it under [devices], see docs/how-to/bench-file.md",
    )


def refuse_needs(bench: Bench, channels: Iterable[str]) -> None:
    """Refuse a plan that needs a channel of a device that is missing.

    Args:
        channels: what the plan's criteria are computed from.

    Raises:
        BenchError: channel, and which devices are missing.
    """
    given = {channel for stream in bench.streams for channel in stream.channels}
    unknown = [name for name in channels if name not in given and name not in CHANNELS]
    if bench.missing and unknown:
        raise BenchError(
            f"the plan needs {printable(', '.join(unknown), 200)}, which no device provides now",
            where=printable(bench.file.source, 200),
            fix=who_is_missing(bench.missing),
        )
