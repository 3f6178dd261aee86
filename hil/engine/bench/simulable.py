"""What of a bench can be simulated or predicted: an RMCU on CAN and dynamometers on CANopen."""

from __future__ import annotations

from drivers import DynoTable, RamTable, RmcuTable
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.model import Model, refuse_without_vehicle
from hil.engine.bench.bench_tables import BenchFile
from hil.plant import refuse_too_stiff
from sim_backend.bench import (
    RAM_BUS,
    RMCU_BUS,
    Noise,
    SensorFault,
    SimulatedBench,
    SimulationSettings,
    check_device_files,
)
from sim_backend.rmcu import RamSettings


def rmcu_of(bench: BenchFile) -> RmcuTable:
    """The RMCU's table.

    Raises:
        BadInputError: it is of a kind that cannot be simulated.
    """
    if not isinstance(bench.rmcu, RmcuTable):
        raise _other_kind("rmcu", bench.rmcu.kind, bench)
    return bench.rmcu


def dyno_of(bench: BenchFile) -> DynoTable:
    """The dynamometers' table.

    Raises:
        BadInputError: they are of a kind that cannot be simulated.
    """
    if not isinstance(bench.dyno, DynoTable):
        raise _other_kind("dyno", bench.dyno.kind, bench)
    return bench.dyno


def ram_of(bench: BenchFile) -> RamTable | None:
    """The table of the monitor of the RMCU's memory; the first, if there are several."""
    return next((table for table in bench.devices.values() if isinstance(table, RamTable)), None)


def check_simulable(bench: BenchFile) -> None:
    """Refuse device files that no simulated bench can be made of.

    Raises:
        BadInputError: file and what it lacks.
    """
    rmcu = rmcu_of(bench)
    check_device_files(rmcu.dbc, dyno_of(bench).eds, rmcu.names)


def simulated(bench: BenchFile, model: Model) -> SimulatedBench:
    """The simulated bench that a bench file describes, around a model.

    Raises:
        BadInputError: something of it cannot be simulated.
    """
    assert bench.simulation is not None
    refuse_without_vehicle(model, str(bench.simulation.model), "simulate a bench")
    refuse_too_stiff(model)
    rmcu, dyno, noise = rmcu_of(bench), dyno_of(bench), bench.simulation.noise
    return SimulatedBench(
        SimulationSettings(
            model=model,
            dbc=rmcu.dbc,
            eds=dyno.eds,
            names=rmcu.names,
            rear_left=dyno.rear_left,
            rear_right=dyno.rear_right,
            idle=tuple(dyno.idle.values()),
            rmcu_bit_rate=bench.buses[rmcu.bus].bit_rate,
            dyno_bit_rate=bench.buses[dyno.bus].bit_rate,
            wheel_radius_m=bench.vehicle.wheel_radius_m,
            seed=bench.simulation.seed,
            held=bench.simulation.rmcu,
            ram=_ram_settings(bench),
            sensors={
                name: SensorFault(table.gain, table.offset)
                for name, table in bench.simulation.sensors.items()
            },
            noise=Noise(noise.motor_speed_rad_s, noise.wheel_speed_rad_s, noise.shaft_torque_nm),
        )
    )


def _ram_settings(bench: BenchFile) -> RamSettings | None:
    table = ram_of(bench)
    if table is None:
        return None
    file, variables, (request_id, answer_id) = table.read()
    return RamSettings(
        bus=RMCU_BUS if table.bus == rmcu_of(bench).bus else RAM_BUS,
        bit_rate=bench.buses[table.bus].bit_rate,
        request_id=request_id,
        answer_id=answer_id,
        variables=variables,
        order=file.order or "<",
        software=file.software,
        software_address=file.software_address,
    )


def _other_kind(key: str, kind: str, bench: BenchFile) -> BadInputError:
    return BadInputError(
        f"{key}.kind = '{printable(kind)}' cannot be simulated or predicted",
        where=printable(bench.source, 200),
        fix="only RMCUs of kind 'rmcu-can' and dynos of kind 'rcs-canopen' can",
    )
