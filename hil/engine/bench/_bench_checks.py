"""What in a bench file contradicts itself, or the files that it names, though every key is right alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

import can

from drivers import DynoTable, RamTable, RmcuTable, read_rmcu
from hil.core.errors import BadInputError
from hil.core.errors.wording import closest, did_you_mean, is_printable, printable
from hil.core.files import is_file
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_settings import adapter_mistakes, identity_of, slows_down
from hil.engine.bench.simulable import check_simulable, ram_of, rmcu_of
from hil.plant.controller import in_range
from sim_backend.bench import DYNO_BUS, RAM_BUS, RMCU_BUS, SENSED_CHANNELS
from sim_backend.rmcu import INTERNALS

SIMULATED = "hil-sim"

_LINES = str.maketrans("", "", "\n\t")  # a description of the DUT may have lines
# What the bench file's own keys give to python-can
_OURS = {"interface", "channel", "bitrate", "fd", "data_bitrate", "timing"}


def unprintable(data: dict[str, Any], place: str = "") -> list[str]:
    """Keys and texts that would reach terminals and reports with control characters in them."""
    found = []
    for key, value in data.items():
        name = f"{place}{printable(key)}"
        if not is_printable(key):
            found.append(f"{name}: the key has control characters; leave them out")
        if isinstance(value, dict):
            found += unprintable(value, f"{name}.")
        elif isinstance(value, str) and not is_printable(
            value.translate(_LINES) if place == "dut." else value
        ):
            found.append(f"{name} = {printable(repr(value))}: has control characters; leave them out")
    return found


def contradictions(bench: BenchFile) -> list[str]:
    """Mistakes that show without opening another file."""
    own = [
        f"{key}.{mistake}" for key, table in bench.device_tables.items() for mistake in table.contradictions()
    ]
    return [
        *own,
        *_of_uses(bench),
        *_of_interfaces(bench),
        *_of_simulation(bench),
        *_of_sensors(bench),
        *_of_time_scale(bench),
    ]


def file_mistakes(devices: Mapping[str, Any], model: Path | None) -> list[str]:
    """What is wrong with the files that a bench file names.

    Args:
        devices: tables by their keys, those under `devices` by their names.
        model: of the simulated bench.
    """
    own = {key: table for key, table in devices.items() if key != "devices"}
    tables = own | {f"devices.{printable(name)}": table for name, table in devices["devices"].items()}
    found = []
    for key, table in tables.items():
        for file, error in table.unusable_files():
            name = printable(getattr(table, file).name)
            found.append(f"{key}.{file} = '{name}': {_on_one_line(error)}")
    if model is not None and not is_file(model):
        found.append(f"simulation.model = '{printable(model.name)}': there is no such file")
    return found


def device_mistakes(bench: BenchFile) -> list[str]:
    """What of the devices cannot be simulated, and identifiers that meet on one bus."""
    found: list[str] = []
    if bench.simulation:
        try:
            check_simulable(bench)
            found += _of_held_parameters(bench)
        except BadInputError as error:
            found.append(f"for the simulated bench: {_on_one_line(error)}")
    return found or [*_of_identifiers(bench), *_of_loads(bench)]


def _buses_of(bench: BenchFile) -> dict[str, str]:
    """The CAN bus that each device is on, by the key of its table."""
    buses = {key: getattr(table, "bus", None) for key, table in bench.device_tables.items()}
    return {key: bus for key, bus in buses.items() if isinstance(bus, str)}


def _of_uses(bench: BenchFile) -> Iterator[str]:
    used = {f"{key}.bus": bus for key, bus in _buses_of(bench).items()}
    known = ", ".join(bench.buses) or "none"
    for key, wanted in used.items():
        if wanted not in bench.buses:
            shown = printable(wanted)
            yield f"{key} = '{shown}': bus '{shown}' is not under [buses]; known: {known}"
    for name in bench.buses:
        if name not in used.values():
            yield f"buses.{name}: no device uses it; name it under [rmcu], [dyno] or [devices], or remove it"
    seen: dict[str, str] = {}
    for name, bus in bench.buses.items():
        other = seen.setdefault(identity_of(bus) or f"{bus.interface} {bus.channel}", name)
        if other != name:
            yield (
                f"buses.{name}.channel = '{printable(bus.channel)}': is also buses.{other}; "
                "give each bus a channel of its own, or put RMCU and dynos on one bus"
            )


def _of_simulation(bench: BenchFile) -> Iterator[str]:
    """Kinds of device that the simulated bench does not stand in for."""
    if bench.simulation:
        for key, table, kind in (("rmcu", bench.rmcu, RmcuTable), ("dyno", bench.dyno, DynoTable)):
            if not isinstance(table, kind):
                known = kind.model_fields["kind"].default
                yield f"{key}.kind = '{printable(table.kind)}': the simulated bench has only '{known}'"
        yield from _of_simulated_memory(bench)


def _of_simulated_memory(bench: BenchFile) -> Iterator[str]:
    """What the simulated RMCU has not in its memory."""
    tables = {key: t for key, t in bench.device_tables.items() if isinstance(t, RamTable)}
    for key, table in tables.items():
        if table is not ram_of(bench):
            yield f"{key}.kind = '{table.kind}': the simulated RMCU supports one RAM monitor; remove one"
        if table.bus == _buses_of(bench).get("dyno"):
            yield f"{key}.bus = '{table.bus}': the simulated RMCU is not on the dynos' bus; give it another"
        for name in table.channels:
            if name not in INTERNALS:
                hint = did_you_mean(name, INTERNALS)
                yield f"{key}.channels.{printable(name, 60)}: the simulated RMCU has no such variable; {hint}"


def _of_sensors(bench: BenchFile) -> Iterator[str]:
    """Sensors that the simulated bench does not have."""
    for name in bench.simulation.sensors if bench.simulation else ():
        if name not in SENSED_CHANNELS:
            hint = did_you_mean(name, SENSED_CHANNELS)
            yield f"simulation.sensors.{printable(name, 60)}: the simulated bench has no such sensor; {hint}"


def _of_time_scale(bench: BenchFile) -> Iterator[str]:
    """Hardware knows one time: its time-outs are not to be stretched."""
    if bench.time_scale == 1.0:
        return
    key = f"time_scale = {bench.time_scale:g}"
    if bench.simulation:
        yield f"{key}: the simulated bench computes its time; leave it out"
    for name, bus in bench.buses.items():
        if not bench.simulation and not slows_down(bus):
            shown = printable(bus.interface)
            yield f"{key}: buses.{name} ('{shown}') may be hardware, which keeps real time; leave it out"


def _of_held_parameters(bench: BenchFile) -> Iterator[str]:
    """Parameters that the simulated RMCU is to keep, but does not know or would refuse."""
    assert bench.simulation is not None
    if not bench.simulation.rmcu:
        return
    rmcu = rmcu_of(bench)
    known = sorted(read_rmcu(rmcu.dbc, rmcu.names).texts.get(("RMCU_ParameterWrite", "Index"), {}))
    for name, value in bench.simulation.rmcu.items():
        key = f"simulation.rmcu.{printable(name)}"
        if name not in known:
            yield f"{key}: the RMCU has no such parameter; {did_you_mean(name, known)}"
        elif not in_range(name, value):
            yield f"{key} = {value:g}: the RMCU does not take this value"


def _of_interfaces(bench: BenchFile) -> Iterator[str]:
    for name, bus in bench.buses.items():
        key = f"buses.{name}.interface = '{printable(bus.interface)}'"
        if bus.interface not in can.VALID_INTERFACES:
            near = closest(bus.interface, can.VALID_INTERFACES)
            known = f"did you mean '{near}'?" if near else f"known: {', '.join(sorted(can.VALID_INTERFACES))}"
            yield f"{key}: python-can has no such interface; {known}"
        elif bench.simulation and bus.interface != SIMULATED:
            yield f"{key}: hardware with [simulation]; leave [simulation] out, or make it '{SIMULATED}'"
        elif not bench.simulation and bus.interface == SIMULATED:
            yield f"{key}: a simulated bus without [simulation]; add [simulation] with a model"
        elif bus.interface == SIMULATED:
            yield from _of_simulated_bus(bench, name)
        else:
            yield from adapter_mistakes(name, bus)
        for option in sorted(_OURS & bus.options.keys()):
            ours = "interface, channel, bit_rate, fd, data_bit_rate, timing"
            yield f"buses.{name}.options.{option}: must be set outside of options ({ours})"


def _of_simulated_bus(bench: BenchFile, name: str) -> Iterator[str]:
    bus, buses = bench.buses[name], _buses_of(bench)
    ram = ram_of(bench)
    memory = ram is not None and ram.bus == name
    role = RMCU_BUS if name == buses.get("rmcu") else DYNO_BUS if name == buses.get("dyno") else RAM_BUS
    if buses.get("rmcu") == buses.get("dyno"):
        yield f"dyno.bus = '{name}': is also rmcu.bus; the simulated bench has a bus for each"
    elif (memory or name in (buses.get("rmcu"), buses.get("dyno"))) and bus.channel != f"{bench.name}/{role}":
        yield (
            f"buses.{name}.channel = '{printable(bus.channel)}': "
            f"with name = '{bench.name}' this simulated bus is '{bench.name}/{role}'"
        )
    for key in ("options", "fd", "data_bit_rate", "timing"):
        if getattr(bus, key):
            yield f"buses.{name}.{key}: the simulated bench takes none; leave it out"


def _of_identifiers(bench: BenchFile) -> Iterator[str]:
    """Identifiers of frames of two devices that would be taken for each other."""
    buses = _buses_of(bench)
    for (first, bus), (second, other) in combinations(buses.items(), 2):
        if bus != other:
            continue
        tables = bench.device_tables
        taken, later = tables[first].identifiers(), tables[second].identifiers()
        for number in sorted(taken.keys() & later.keys()):
            yield (
                f"{second}.bus = '{bus}': is also {first}.bus, and 0x{number:03X} is both "
                f"{taken[number]} and {later[number]}; give them a bus each, or other identifiers"
            )


def _of_loads(bench: BenchFile) -> Iterator[str]:
    """A further device for whose frames there is no room beside those that come all the time."""
    buses = _buses_of(bench)
    for key, table in bench.device_tables.items():
        own = table.bits_each_second()
        if not own or key not in buses or not key.startswith("devices."):
            continue
        bus, name = bench.buses[buses[key]], buses[key]
        others = [t for k, t in bench.device_tables.items() if buses.get(k) == name and k != key]
        there = sum(other.bits_each_second() for other in others)
        if there + own > bus.bit_rate:
            yield (
                f"{key}.bus = '{printable(name)}': its frames take up to {own / 1e3:.0f} kbit/s, those of "
                f"others {there / 1e3:.0f}, the bus has {bus.bit_rate / 1e3:.0f}; give it a bus of its own, "
                "measure fewer channels, or only every 2nd sample (every = 2)"
            )


def _on_one_line(error: BadInputError) -> str:
    """What an error of a named file says, after the key that names the file."""
    where = error.where.partition(", ")[2]  # behind the path, which the key shows already
    text = f"{where}: {error.what}" if where else error.what
    return f"{text}; {error.fix}" if error.fix else text
