"""Opens a bench: buses, clock, drivers; real or simulated by what the bench file says."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass

import can

from drivers import BusLoop, DynoDriver, DynoNodes, RmcuDriver, VehicleParameters, Wire
from hil.core.clock import Clock, WallClock
from hil.core.errors import BadInputError, BenchError
from hil.core.model import Model, load_model
from hil.core.printable import printable
from hil.engine.bench_file import BenchFile
from sim_backend.bench import Noise, SimulatedBench, SimulationSettings
from sim_backend.can_interface import attach, detach


@dataclass
class Bench:
    """An open bench."""

    file: BenchFile
    loop: BusLoop
    rmcu: RmcuDriver
    dyno: DynoDriver
    model: Model | None

    @property
    def simulated(self) -> bool:
        """Whether there is no hardware."""
        return self.model is not None


@contextlib.contextmanager
def open_bench(file: BenchFile, *, model: Model | None = None) -> Iterator[Bench]:
    """Open every bus and make the drivers; close the buses at the end.

    Args:
        model: takes the place of the bench file's model on a simulated bench.

    Raises:
        BadInputError: a file that the bench file names cannot be used.
        BenchError: a bus cannot be opened.
    """
    clock: Clock = WallClock()
    offset_s = time.time() - clock.now_s()
    if file.simulation:
        model = model or load_model(file.simulation.model)
        world = _simulated(file, model)
        attach(file.name, world)
        clock, offset_s = world, 0.0
    elif model is not None:
        raise BadInputError(
            "--model goes with a simulated bench only", where=str(file.source), fix="leave --model out"
        )
    wires: dict[str, Wire] = {}
    try:
        for name, bus in file.buses.items():
            opened = _open(name, bus.interface, bus.channel, bus.bit_rate, bus.options)
            wires[name] = Wire(name, opened, clock, epoch_offset_s=offset_s)
        loop = BusLoop(clock, list(wires.values()))
        v, d = file.vehicle, file.dyno
        vehicle = VehicleParameters(v.wheel_radius_m, v.slip, v.inertia_kg_m2, v.rolling_nm, v.aero_nms2_rad2)
        nodes = DynoNodes(d.rear_left, d.rear_right, dict(d.idle), d.host_node)
        rmcu = RmcuDriver(loop, wires[file.rmcu.bus], file.rmcu.dbc)
        dyno = DynoDriver(loop, wires[d.bus], d.eds, nodes, vehicle)
        yield Bench(file, loop, rmcu, dyno, model)
    finally:
        for wire in wires.values():
            wire.close()
        detach(file.name)


def _open(name: str, interface: str, channel: str, bit_rate: int, options: dict[str, object]) -> can.BusABC:
    try:
        return can.Bus(interface=interface, channel=channel, bitrate=bit_rate, **options)  # type: ignore[arg-type]
    except Exception as error:  # an adapter's own software raises what it likes
        raise BenchError(
            f"cannot be opened: {printable(error, 200) or type(error).__name__}",
            where=f"bus '{name}' ({interface} {channel})",
            fix="check [buses] in the bench file, the adapter and its driver",
        ) from error


def _simulated(file: BenchFile, model: Model) -> SimulatedBench:
    assert file.simulation is not None
    noise = file.simulation.noise
    return SimulatedBench(
        SimulationSettings(
            model=model,
            dbc=file.rmcu.dbc,
            eds=file.dyno.eds,
            rear_left=file.dyno.rear_left,
            rear_right=file.dyno.rear_right,
            idle=tuple(file.dyno.idle.values()),
            rmcu_bit_rate=file.buses[file.rmcu.bus].bit_rate,
            dyno_bit_rate=file.buses[file.dyno.bus].bit_rate,
            wheel_radius_m=file.vehicle.wheel_radius_m,
            seed=file.simulation.seed,
            noise=Noise(noise.motor_speed_rad_s, noise.wheel_speed_rad_s, noise.shaft_torque_nm),
        )
    )
