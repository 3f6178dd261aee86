"""Bench files: interfaces, node ids, DBC/EDS, limits, calibration, DUT. A plan never names hardware."""

from __future__ import annotations

import datetime
import importlib.resources
import tomllib
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.printable import printable
from hil.engine._bench_checks import contradictions, device_mistakes, unprintable

DEFAULT_BENCH = "sim"

_FIX = "see docs/how-to/bench-file.md"
_LONGEST_NAME = 64
_LOADED = ("text", "source")  # fields of the loaded bench that are no keys of the file


def _date(value: object) -> object:
    """A date as TOML has it, also in quotes; no number, which would count as seconds since 1970."""
    if isinstance(value, str) and len(value) == len("2027-06-30"):
        return datetime.date.fromisoformat(value)
    if not isinstance(value, datetime.date) or isinstance(value, datetime.datetime):
        raise ValueError("is no date; write the last valid day as 2027-06-30")
    return value


def _plain_name(value: object) -> object:
    """A name that can stand in a file's name, a topic and a channel."""
    if isinstance(value, str) and (set(value) & {"/", "\\"} or value.strip(" .") != value):
        raise ValueError("is a path or has spaces around it; give a plain name, such as 'rear_axle'")
    return value


Name = Annotated[str, Field(min_length=1, max_length=_LONGEST_NAME), BeforeValidator(_plain_name)]
File = Annotated[Path, Field(strict=False)]
Day = Annotated[datetime.date, BeforeValidator(_date)]
NodeId = Annotated[int, Field(ge=1, le=127)]
Limit = Annotated[float, Field(gt=0, le=1e6, description="beyond 1e6 it would limit nothing")]
Deviation = Annotated[float, Field(ge=0, le=1e4)]


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, strict=True)


class Bus(_Table):
    """One CAN bus, opened by python-can."""

    interface: str = Field(min_length=1)
    channel: str = Field(min_length=1)
    bit_rate: int = Field(ge=10_000, le=1_000_000, description="bit/s")
    options: dict[str, Any] = Field({}, description="further arguments for can.Bus")


class Rmcu(_Table):
    """Where the RMCU is."""

    bus: str
    dbc: File


class Dyno(_Table):
    """Where the dynamometers are."""

    bus: str
    eds: File
    rear_left: NodeId = 3
    rear_right: NodeId = 4
    idle: dict[Name, NodeId] = Field({}, description="nodes that are watched but not used")
    host_node: NodeId = 127
    speed_ramp_m_s2: float = Field(4.0, ge=0.01, le=100.0)


class Vehicle(_Table):
    """The dynos' vehicle model; what is left out keeps the controller's value."""

    wheel_radius_m: float = Field(0.33, ge=0.01, le=10.0)
    slip: float = Field(0.0, ge=0, lt=1)
    inertia_kg_m2: float | None = Field(None, gt=0, le=1e6)
    rolling_nm: float | None = Field(None, ge=0, le=1e6)
    aero_nms2_rad2: float | None = Field(None, ge=0, le=1e6)


class Limits(_Table):
    """What the bench never exceeds; magnitudes. They lie below every plan."""

    motor_torque_nm: Limit
    driving_torque_nm: Limit
    shaft_torque_nm: Limit
    motor_speed_rad_s: Limit
    wheel_speed_rad_s: Limit
    vehicle_speed_m_s: Limit
    persistence_s: float = Field(0.005, ge=0, le=10, description="a limit trips when exceeded for longer")


class NoiseTable(_Table):
    """Standard deviations of the simulated sensors."""

    motor_speed_rad_s: Deviation = 0.02
    wheel_speed_rad_s: Deviation = 0.002
    shaft_torque_nm: Deviation = 0.5


class Simulation(_Table):
    """A simulated bench in place of hardware."""

    model: File
    seed: int = Field(1, ge=0, le=2**63 - 1)
    noise: NoiseTable = NoiseTable()


class BenchFile(_Table):
    """One bench file; paths are absolute once it is loaded."""

    name: Name
    title: str = ""
    operator: str = ""
    buses: dict[Name, Bus]
    rmcu: Rmcu
    dyno: Dyno
    limits: Limits
    vehicle: Vehicle = Vehicle()
    dut: dict[str, str] = {}
    calibration: dict[str, Day] = Field({}, description="sensor: valid until")
    simulation: Simulation | None = None
    text: str = ""
    source: File = Path()


def load_bench(name_or_path: str | Path) -> BenchFile:
    """Read a bench file by path, or one of `benches/` by name.

    The files that it names are read too: what is wrong with the DBC or the EDS is said now.

    Raises:
        BadInputError: not found, or all that is wrong with it: file, keys, values, and what to do.
    """
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = _shipped_bench(str(name_or_path))
    text = read_text(path)
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise BadInputError(
            f"not a TOML file: {printable(error, 200)}", where=printable(path, 200), fix=_FIX
        ) from error
    return bench_from_dict(data, text, path)


def bench_from_dict(data: dict[str, Any], text: str, path: Path) -> BenchFile:
    """Check the contents of a bench file; paths in it are relative to the file.

    Raises:
        BadInputError: all that is wrong with it.
    """
    where = printable(path, 200)
    _refuse(where, [*unprintable(data), *(f"{key}: unknown key" for key in _LOADED if key in data)])
    try:
        bench = BenchFile.model_validate({**data, "text": text, "source": path.resolve()})
    except ValidationError as error:
        _refuse(where, [_told(dict(mistake)) for mistake in error.errors()])
        raise
    _refuse(where, contradictions(bench))
    base = path.resolve().parent
    changes: dict[str, Any] = {
        "rmcu": bench.rmcu.model_copy(update={"dbc": base / bench.rmcu.dbc}),
        "dyno": bench.dyno.model_copy(update={"eds": base / bench.dyno.eds}),
    }
    if bench.simulation:
        changes["simulation"] = bench.simulation.model_copy(update={"model": base / bench.simulation.model})
    loaded = bench.model_copy(update=changes)
    _refuse(where, device_mistakes(loaded))
    return loaded


def _refuse(where: str, mistakes: list[str]) -> None:
    """Tell every mistake of a file, each on a line; nothing if there is none.

    Raises:
        BadInputError: there are mistakes.
    """
    if len(mistakes) == 1:
        raise BadInputError(mistakes[0], where=where, fix=_FIX)
    if mistakes:
        lines = "".join(f"\n  {mistake}" for mistake in mistakes)
        raise BadInputError(f"{len(mistakes)} mistakes{lines}", where=where, fix=_FIX)


def _told(mistake: dict[str, Any]) -> str:
    """One of pydantic's errors: key, value, and what would be right."""
    key = printable(".".join(str(part) for part in mistake["loc"] if part != "[key]"), 120)
    if mistake["type"] == "missing":
        return f"{key}: is missing"
    if mistake["type"] == "extra_forbidden":
        return f"{key}: unknown key"
    value = mistake["input"]
    shown = "a table" if isinstance(value, dict) else printable(repr(value), 60)
    said = str(mistake["msg"]).removeprefix("Value error, ")
    return f"{key} = {shown}: {said[:1].lower()}{said[1:]}"


def _shipped_bench(name: str) -> Path:
    path = shipped(f"{name}.toml")
    try:
        if path.is_file():
            return path
    except (OSError, ValueError):  # no file can have such a name
        pass
    known = sorted(p.stem for p in path.parent.glob("*.toml") if "[buses." in p.read_text("utf-8"))
    raise BadInputError(
        f"there is no bench '{printable(name)}'",
        fix=f"shipped: {', '.join(known)}; or give a file, whose name ends in .toml",
    )


def shipped(name: str) -> Path:
    """Path of a file of the shipped `benches`."""
    return Path(str(importlib.resources.files("benches"))) / name
