"""What in a bench file contradicts itself, or the files that it names, though every key is right alone."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import can

from drivers import identifiers_of, read_dyno, read_rmcu
from hil.core.errors import BadInputError
from hil.core.printable import is_printable, printable
from sim_backend.bench import DYNO_BUS, RMCU_BUS, check_device_files

if TYPE_CHECKING:
    from hil.engine.bench_file import BenchFile

SIMULATED = "hil-sim"

_LINES = str.maketrans("", "", "\n\t")  # a description of the DUT may have lines
_OURS = {"interface", "channel", "bitrate"}  # what the bench file's own keys give to python-can


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
    return [*_of_nodes(bench), *_of_uses(bench), *_of_interfaces(bench)]


def device_mistakes(bench: BenchFile) -> list[str]:
    """What is wrong with the DBC and the EDS, and identifiers that meet on one bus."""
    found = []
    for key, path, read in (
        ("rmcu.dbc", bench.rmcu.dbc, read_rmcu),
        ("dyno.eds", bench.dyno.eds, lambda path: read_dyno(path, bench.dyno.rear_left)),
    ):
        try:
            read(path)
        except BadInputError as error:
            found.append(f"{key} = '{printable(path.name)}': {_on_one_line(error)}")
    if not found and bench.simulation:
        try:
            check_device_files(bench.rmcu.dbc, bench.dyno.eds)
        except BadInputError as error:
            found.append(f"for the simulated bench: {_on_one_line(error)}")
    if not found and bench.rmcu.bus == bench.dyno.bus:
        found += _of_identifiers(bench)
    return found


def nodes_of(bench: BenchFile) -> dict[str, int]:
    """Node ids on the dynos' bus by their keys."""
    d = bench.dyno
    idle = {f"idle.{name}": node for name, node in d.idle.items()}
    return {"rear_left": d.rear_left, "rear_right": d.rear_right, **idle, "host_node": d.host_node}


def _of_nodes(bench: BenchFile) -> Iterator[str]:
    seen: dict[int, str] = {}
    for key, node in nodes_of(bench).items():
        other = seen.setdefault(node, key)
        if other != key:
            yield f"dyno.{key} = {node}: is also {other}; every node on a bus has an id of its own"


def _of_uses(bench: BenchFile) -> Iterator[str]:
    used = {"rmcu.bus": bench.rmcu.bus, "dyno.bus": bench.dyno.bus}
    known = ", ".join(bench.buses) or "none"
    for key, wanted in used.items():
        if wanted not in bench.buses:
            shown = printable(wanted)
            yield f"{key} = '{shown}': bus '{shown}' is not under [buses]; known: {known}"
    for name in bench.buses:
        if name not in used.values():
            yield f"buses.{name}: is used by nothing; name it under [rmcu] or [dyno], or leave it out"
    seen: dict[tuple[str, str], str] = {}
    for name, bus in bench.buses.items():
        other = seen.setdefault((bus.interface, bus.channel), name)
        if other != name:
            yield (
                f"buses.{name}.channel = '{printable(bus.channel)}': is also buses.{other}; "
                "give each bus a channel of its own, or put RMCU and dynos on one bus"
            )


def _of_interfaces(bench: BenchFile) -> Iterator[str]:
    for name, bus in bench.buses.items():
        key = f"buses.{name}.interface = '{printable(bus.interface)}'"
        if bus.interface not in can.VALID_INTERFACES:
            near = difflib.get_close_matches(bus.interface, can.VALID_INTERFACES, 1)
            known = (
                f"did you mean '{near[0]}'?" if near else f"known: {', '.join(sorted(can.VALID_INTERFACES))}"
            )
            yield f"{key}: python-can has no such interface; {known}"
        elif bench.simulation and bus.interface != SIMULATED:
            yield f"{key}: hardware with [simulation]; leave [simulation] out, or make it '{SIMULATED}'"
        elif not bench.simulation and bus.interface == SIMULATED:
            yield f"{key}: a simulated bus without [simulation]; add [simulation] with a model"
        elif bus.interface == SIMULATED:
            yield from _of_simulated_bus(bench, name)
        for option in sorted(_OURS & bus.options.keys()):
            yield f"buses.{name}.options.{option}: stands outside of options (interface, channel, bit_rate)"


def _of_simulated_bus(bench: BenchFile, name: str) -> Iterator[str]:
    bus = bench.buses[name]
    role = RMCU_BUS if name == bench.rmcu.bus else DYNO_BUS
    if bench.rmcu.bus == bench.dyno.bus:
        yield f"dyno.bus = '{name}': is also rmcu.bus; the simulated bench has a bus for each"
    elif name in (bench.rmcu.bus, bench.dyno.bus) and bus.channel != f"{bench.name}/{role}":
        yield (
            f"buses.{name}.channel = '{printable(bus.channel)}': "
            f"with name = '{bench.name}' this simulated bus is '{bench.name}/{role}'"
        )
    if bus.options:
        yield f"buses.{name}.options: the simulated bench takes none; leave them out"


def _of_identifiers(bench: BenchFile) -> Iterator[str]:
    """Identifiers of RMCU and CANopen frames that would be taken for each other."""
    taken: dict[int, str] = {}
    for key, node in nodes_of(bench).items():
        taken |= identifiers_of(node, key)
    for layout in read_rmcu(bench.rmcu.dbc).layouts.values():
        if layout.id in taken:
            yield (
                f"dyno.bus = '{bench.dyno.bus}': is also rmcu.bus, and 0x{layout.id:03X} is both "
                f"'{layout.name}' and {taken[layout.id]}; give them a bus each, or other identifiers"
            )


def _on_one_line(error: BadInputError) -> str:
    """What an error of a named file says, after the key that names the file."""
    where = error.where.partition(", ")[2]  # behind the path, which the key shows already
    said = f"{where}: {error.what}" if where else error.what
    return f"{said}; {error.fix}" if error.fix else said
