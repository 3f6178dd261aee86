"""Bench files: interfaces, node ids, DBC/EDS, limits, calibration, DUT. A plan never names hardware."""

from __future__ import annotations

import datetime
import importlib.resources
import tomllib
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hil.core.errors import BadInputError
from hil.core.files import read_text

DEFAULT_BENCH = "sim"


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Bus(_Table):
    """One CAN bus, opened by python-can."""

    interface: str
    channel: str
    bit_rate: int = Field(gt=0, description="bit/s")
    options: dict[str, Any] = Field({}, description="further arguments for can.Bus")


class Rmcu(_Table):
    """Where the RMCU is."""

    bus: str
    dbc: Path


class Dyno(_Table):
    """Where the dynamometers are."""

    bus: str
    eds: Path
    rear_left: int = Field(3, ge=1, le=126)
    rear_right: int = Field(4, ge=1, le=126)
    idle: dict[str, int] = Field({}, description="nodes that are watched but not used")
    host_node: int = Field(127, ge=1, le=127)
    speed_ramp_m_s2: float = Field(4.0, gt=0)


class Vehicle(_Table):
    """The dynos' vehicle model; what is left out keeps the controller's value."""

    wheel_radius_m: float = Field(0.33, gt=0)
    slip: float = Field(0.0, ge=0, lt=1)
    inertia_kg_m2: float | None = Field(None, gt=0)
    rolling_nm: float | None = Field(None, ge=0)
    aero_nms2_rad2: float | None = Field(None, ge=0)


class Limits(_Table):
    """What the bench never exceeds; magnitudes. They lie below every plan."""

    motor_torque_nm: float = Field(gt=0)
    driving_torque_nm: float = Field(gt=0)
    shaft_torque_nm: float = Field(gt=0)
    motor_speed_rad_s: float = Field(gt=0)
    wheel_speed_rad_s: float = Field(gt=0)
    vehicle_speed_m_s: float = Field(gt=0)
    persistence_s: float = Field(0.005, ge=0, description="a limit trips when exceeded for longer")


class NoiseTable(_Table):
    """Standard deviations of the simulated sensors."""

    motor_speed_rad_s: float = Field(0.02, ge=0)
    wheel_speed_rad_s: float = Field(0.002, ge=0)
    shaft_torque_nm: float = Field(0.5, ge=0)


class Simulation(_Table):
    """A simulated bench in place of hardware."""

    model: Path
    seed: int = 1
    noise: NoiseTable = NoiseTable()


class BenchFile(_Table):
    """One bench file; paths are absolute once it is loaded."""

    name: str = Field(min_length=1)
    title: str = ""
    operator: str = ""
    buses: dict[str, Bus]
    rmcu: Rmcu
    dyno: Dyno
    limits: Limits
    vehicle: Vehicle = Vehicle()
    dut: dict[str, str] = {}
    calibration: dict[str, datetime.date] = Field({}, description="sensor: valid until")
    simulation: Simulation | None = None
    text: str = ""
    source: Path = Path()


def load_bench(name_or_path: str | Path) -> BenchFile:
    """Read a bench file by path, or one of `benches/` by name.

    Raises:
        BadInputError: not found, or a key that is unknown, missing or out of range.
    """
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = shipped(f"{name_or_path}.toml")
        if not path.is_file():
            known = sorted(p.stem for p in path.parent.glob("*.toml") if "[buses." in p.read_text("utf-8"))
            raise BadInputError(
                f"there is no bench '{name_or_path}'", fix=f"shipped: {', '.join(known)}; or give a file"
            )
    text = read_text(path)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BadInputError(f"not a TOML file: {error}", where=str(path)) from error
    return bench_from_dict(data, text, path)


def bench_from_dict(data: dict[str, Any], text: str, path: Path) -> BenchFile:
    """Check the contents of a bench file; paths in it are relative to the file."""
    try:
        bench = BenchFile.model_validate({**data, "text": text, "source": path.resolve()})
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise BadInputError(
            f"{key}: {first['msg']}", where=str(path), fix="see docs/how-to/bench-file.md"
        ) from error
    base = path.resolve().parent
    for table in (bench.rmcu, bench.dyno):
        if table.bus not in bench.buses:
            raise BadInputError(
                f"bus '{table.bus}' is not under [buses]",
                where=str(path),
                fix=f"known: {', '.join(bench.buses)}",
            )
    changes: dict[str, Any] = {
        "rmcu": bench.rmcu.model_copy(update={"dbc": base / bench.rmcu.dbc}),
        "dyno": bench.dyno.model_copy(update={"eds": base / bench.dyno.eds}),
    }
    if bench.simulation:
        changes["simulation"] = bench.simulation.model_copy(update={"model": base / bench.simulation.model})
    return bench.model_copy(update=changes)


def shipped(name: str) -> Path:
    """Path of a file of the shipped `benches`."""
    return Path(str(importlib.resources.files("benches"))) / name
