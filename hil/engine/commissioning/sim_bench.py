"""The simulated bench of a bench file as a process of its own, in wall-clock time, for other processes."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import tomli_w

from drivers import PanelTable, RamTable, RmcuTable
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError, BenchError
from hil.core.errors.wording import printable
from hil.core.model import Model, load_model, model_from_dict, model_to_toml
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.simulable import dyno_of, ram_of, rmcu_of, simulated
from hil.engine.stop.stopping import StopRequest
from hil.plant import refuse_too_stiff
from sim_backend.bench import DYNO_BUS, RAM_BUS, RMCU_BUS, SimulatedBench
from sim_backend.rcs import EmulatedPanel, PanelPort
from sim_backend.serving import (
    BenchServer,
    BusServer,
    Pace,
    SlcanPort,
    SocketcandPort,
    SocketcanPort,
    UdpHub,
)

TRANSPORTS = ("udp", "slcan", "socketcand", "socketcan")
HIDDEN_FORM = "EFFECT=VALUE or EFFECT.PARAMETER=VALUE"
FIRST_PORT = 47110
_HIGHEST_PORT = 65535


@dataclass(frozen=True)
class Serving:
    """What is served: reported before the first millisecond passes.

    Attributes:
        bench_file: text of the bench file that connects to it.
        buses: for each bus of the bench file what its table says.
        hidden: effects that were added to the model, with their numbers.
        left_out: devices of the bench file that nothing stands in for here.
    """

    bench_file: str
    buses: Mapping[str, Mapping[str, Any]]
    hidden: tuple[str, ...]
    left_out: tuple[str, ...]


@dataclass(frozen=True)
class Served:
    """How it went; `frames` sent and received and `lost` frames by bus."""

    pace: Pace
    frames: Mapping[str, tuple[int, int]]
    lost: Mapping[str, int]


@dataclass
class SimBenchRequest:
    """A simulated bench to be served.

    Attributes:
        bench: with [simulation].
        time_scale: seconds of bench time in a second of the wall clock.
        seed: of the sensors' noise; None: that of the bench file.
        hidden: effects in the served bench beside those of its model: what "backlash" names is the effect's
            first number, "backlash.restitution" another.
        for_s: ends by itself after this many seconds of the wall clock.
        transport: one of `TRANSPORTS`.
        port: first UDP or TCP port; 0 takes free ones.
        interfaces: of SocketCAN, for the RMCU's bus, the dynos' and that of the RMCU's memory, if it has one
            of its own: "can1:can0" serves at can1 those who open can0, another controller on the same bus;
            "vcan0" serves its own.
        ready: called once, when hosts can connect.
    """

    bench: BenchFile
    time_scale: float = 1.0
    seed: int | None = None
    hidden: Mapping[str, str] = field(default_factory=dict)
    for_s: float = float("inf")
    transport: str = "udp"
    port: int = FIRST_PORT
    interfaces: tuple[str, ...] = ()
    ready: Callable[[Serving], None] = lambda serving: None
    stop: StopRequest = field(default_factory=StopRequest)


def serve(request: SimBenchRequest) -> Served:
    """Serve until the request is stopped or its time is over.

    Raises:
        BadInputError: the bench file has no simulation, or something that is asked for makes no sense.
        BenchError: a port is taken.
    """
    bench = _checked(request)
    assert bench.simulation is not None
    shown = load_model(bench.simulation.model)
    refuse_too_stiff(shown)
    model = with_hidden(shown, request.hidden)
    world = simulated(bench, model)
    roles = _roles(bench)
    with contextlib.ExitStack() as opened:
        servers: dict[str, BusServer] = {}
        for number, (role, name) in enumerate(roles.items()):
            port = request.port + number if request.port else 0
            servers[role] = _server(request, number, port, bench.buses[name].bit_rate, name)
            opened.callback(servers[role].close)
        panels = _panels(bench, world, opened)
        duties = [port.tick for port in panels.values()]
        server = BenchServer(world, servers, request.time_scale, duties=duties)
        tables = {
            name: {**servers[role].table, "bit_rate": bench.buses[name].bit_rate}
            for role, name in roles.items()
        }
        ports = {name: port.port for name, port in panels.items()}
        text = bench_text(bench, tables, request.time_scale, ports)
        added = {_effect_and_parameter(name)[0] for name in request.hidden}
        added_texts = tuple(f"{use.id}: {_numbers(use.values)}" for use in model.effects if use.id in added)
        left_out = tuple(name for name in bench.devices if not _is_served(bench, name))
        request.ready(Serving(text, tables, added_texts, left_out))
        server.serve(lambda: request.stop.times > 0, request.for_s)
        frames = {roles[role]: (sent, received) for role, (sent, received) in server.frames.items()}
        lost = {name: servers[role].lost for role, name in roles.items()}
    return Served(server.pace, frames, lost)


def with_hidden(model: Model, hidden: Mapping[str, str]) -> Model:
    """The model with effects added, or with other numbers for those that it has.

    Args:
        hidden: values by "EFFECT" or "EFFECT.PARAMETER".

    Raises:
        BadInputError: no such effect or parameter, or a value that it does not take.
    """
    data = tomllib.loads(model_to_toml(model))
    effects: list[dict[str, Any]] = data.setdefault("effects", [])
    for name, value in hidden.items():
        effect_id, parameter = _effect_and_parameter(name)
        if effect_id not in EFFECTS:
            raise BadInputError(
                f"there is no effect '{printable(effect_id)}'",
                where="--hide",
                fix=f"write --hide {HIDDEN_FORM}; known: {', '.join(EFFECTS)}",
            )
        entry = next((entry for entry in effects if entry["id"] == effect_id), None)
        if entry is None:
            effects.append(entry := {"id": effect_id})
        entry[parameter or EFFECTS[effect_id].acting()[0]] = _number_or_text(value)
    if not effects:
        del data["effects"]
    return model_from_dict(data, "--hide")


def bench_text(
    bench: BenchFile,
    buses: Mapping[str, Mapping[str, Any]],
    time_scale: float,
    ports: Mapping[str, str] | None = None,
) -> str:
    """The bench file for those who connect: the same devices and limits, these buses, no simulation.

    Args:
        ports: serial ports of devices, by their names.
    """
    data = tomllib.loads(bench.text)
    for key in ("simulation", "time_scale"):
        data.pop(key, None)
    devices = {name: table for name, table in data.pop("devices", {}).items() if _is_served(bench, name)}
    for name, table in devices.items():
        described = bench.devices[name]
        if isinstance(described, RamTable):
            table["symbols"] = str(described.symbols)
        if ports and name in ports:
            table["port"] = ports[name]
    if devices:
        data["devices"] = devices
    if time_scale != 1.0:
        data["time_scale"] = time_scale
    data["buses"] = {name: dict(table) for name, table in buses.items()}
    data["rmcu"]["dbc"] = str(rmcu_of(bench).dbc)
    data["dyno"]["eds"] = str(dyno_of(bench).eds)
    return tomli_w.dumps(data)


def _roles(bench: BenchFile) -> dict[str, str]:
    """Buses of the simulated bench, and what the bench file calls them."""
    roles = {RMCU_BUS: rmcu_of(bench).bus, DYNO_BUS: dyno_of(bench).bus}
    ram = ram_of(bench)
    if ram is not None and ram.bus not in roles.values():
        roles[RAM_BUS] = ram.bus
    return roles


def _is_served(bench: BenchFile, name: str) -> bool:
    """Whether something stands in for a device beside RMCU and dynos."""
    return isinstance(bench.devices[name], PanelTable | RamTable)


def _panels(bench: BenchFile, world: SimulatedBench, opened: contextlib.ExitStack) -> dict[str, PanelPort]:
    """A pseudo-terminal for each panel of the bench file."""
    radius_m = bench.vehicle.wheel_radius_m
    found = {}
    for name, table in bench.devices.items():
        if isinstance(table, PanelTable):
            panel = EmulatedPanel(
                lambda vehicle: world.set_vehicle(vehicle.at_wheels(radius_m)), friction=world.has_friction
            )
            found[name] = PanelPort(panel, waits=False)
            opened.callback(found[name].close)
    return found


def _checked(request: SimBenchRequest) -> BenchFile:
    bench = request.bench
    where = printable(bench.source, 200)
    if bench.simulation is None:
        raise BadInputError(
            "has no [simulation]: it is a bench with hardware", where=where, fix="give one such as 'sim'"
        )
    assert isinstance(bench.rmcu, RmcuTable)
    if not 0.001 <= request.time_scale <= 1.0:
        raise BadInputError(
            f"--time-scale is {request.time_scale:g}",
            fix="give 1 for real time, or less to run slower (0.001 to 1)",
        )
    if not request.for_s > 0:
        raise BadInputError(f"--for is {request.for_s:g}", fix="give seconds greater than 0, or leave it out")
    if request.port and not 0 < request.port < _HIGHEST_PORT:
        raise BadInputError(
            f"--port is {request.port}", fix=f"give 1 to {_HIGHEST_PORT - 1}, or 0 for free ones"
        )
    wanted = len(_roles(bench)) if request.transport == "socketcan" else 0
    if len(request.interfaces) != wanted:
        raise BadInputError(
            f"--interface is given {len(request.interfaces)} times, {wanted} are needed",
            fix="'--transport socketcan --interface vcan0 --interface vcan1': RMCU's bus, then the dynos', "
            "then that of a RAM monitor",
        )
    if request.seed is None:
        return bench
    if request.seed < 0:
        raise BadInputError(f"--seed is {request.seed}", fix="give 0 or more")
    return bench.model_copy(update={"simulation": bench.simulation.model_copy(update={"seed": request.seed})})


def _server(request: SimBenchRequest, number: int, port: int, bit_rate: int, name: str) -> BusServer:
    if request.transport == "socketcan":
        return _at_interface(request.interfaces[number], bit_rate, name)
    try:
        if request.transport == "slcan":
            return SlcanPort(bit_rate)
        if request.transport == "socketcand":
            return SocketcandPort(port, name)
        return UdpHub(port, bit_rate, request.time_scale)
    except OSError as error:
        raise BenchError(
            f"port {port} cannot be taken: {error.strerror}",
            where=f"bus '{name}'",
            fix="is another simulated bench running? Name another port with --port, or 0 for free ones",
        ) from error


def _at_interface(interface: str, bit_rate: int, name: str) -> SocketcanPort:
    ours, _, hosts = interface.partition(":")
    try:
        return SocketcanPort(ours, hosts or ours, bit_rate)
    except OSError as error:
        raise BenchError(
            f"the interface '{printable(ours, 20)}' cannot be used: {error.strerror}",
            where=f"bus '{name}'",
            fix="'ip link show type can' and 'ip link show type vcan' list what there is",
        ) from error


def _effect_and_parameter(name: str) -> tuple[str, str]:
    effect_id, _, parameter = name.partition(".")
    return effect_id, parameter


def _numbers(values: Mapping[str, object]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in values.items())


def _number_or_text(value: str) -> float | str:
    try:
        return float(value)
    except ValueError:
        return value
