"""Bench files: interfaces, devices, limits, calibration, DUT. A plan never names hardware.

The bench that is meant where none is named: the `bench.toml` of one's own folder, else the shipped `sim`.

One rule for commands and pytest: beside the plan, else in the current folder. Hardware is never driven
because its file lies there: it is named.

The JSON schema of bench files, for editors.
"""

from __future__ import annotations

import importlib.resources
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError

from drivers import DeviceTable
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import keyed, mistakes_of, refuse
from hil.core.errors.wording import did_you_mean, is_printable, printable
from hil.core.files import is_file
from hil.core.files.shipped import shipped_file
from hil.core.files.toml_file import parse_toml, refuse_other_kind, toml_text
from hil.core.model.schema import DRAFT
from hil.engine.bench._bench_checks import contradictions, device_mistakes, file_mistakes, unprintable
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.device_kinds import DEFAULT_KINDS, KINDS, device_tables

DEFAULT_BENCH = "sim"

_FIX = "see docs/how-to/bench-file.md"
LOADED = ("text", "source")  # fields of the loaded bench that are no keys of the file


def load_bench(name_or_path: str | Path) -> BenchFile:
    """Read a bench file by path, or one of `benches/` by name.

    The files that it names are read too: what is wrong with the DBC or the EDS is stated now.

    Raises:
        BadInputError: not found, or all that is wrong with it: file, keys, values, and what to do.
    """
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = _shipped_bench(str(name_or_path))
    text = toml_text(path)
    data = parse_toml(text, printable(path, 200), _FIX)
    refuse_other_kind(data, "bench file", printable(path, 200))
    return bench_from_dict(data, text, path)


def bench_from_dict(data: dict[str, Any], text: str, path: Path) -> BenchFile:
    """Check the contents of a bench file; paths in it are relative to the file.

    Raises:
        BadInputError: all that is wrong with it.
    """
    where = printable(path, 200)
    unknown = [f"{key}: unknown key" for key in LOADED if key in data]
    _refuse(where, [*unprintable(data), *unknown], text)
    base = path.resolve().parent
    devices, mistakes = device_tables(data)
    of_files = file_mistakes(_beside(devices, base), _model_of(data, base))
    try:
        bench = BenchFile.model_validate({**data, **devices, "text": text, "source": path.resolve()})
    except ValidationError as error:
        further = mistakes_of(error, BenchFile, known=mistakes)
        further = [mistakes_of for mistakes_of in further if not _is_of(mistakes_of, mistakes)]
        _refuse(where, [*mistakes, *further, *of_files], text)
        raise
    _refuse(where, [*(mistakes or contradictions(bench)), *of_files], text)
    changes: dict[str, Any] = _beside(devices, base)
    if bench.simulation:
        model = _model_of(data, base)
        changes["simulation"] = bench.simulation.model_copy(update={"model": model})
    loaded = bench.model_copy(update=changes)
    _refuse(where, device_mistakes(loaded), text)
    return loaded


def with_seed(bench: BenchFile, seed: int) -> BenchFile:
    """A simulated bench with another seed of its noise; its text says so."""
    data = tomllib.loads(bench.text)
    data["simulation"]["seed"] = seed
    return bench_from_dict(data, tomli_w.dumps(data), bench.source)


def _beside(devices: dict[str, Any], base: Path) -> dict[str, Any]:
    """The device tables that are right, with their files as they lie beside the bench file."""
    found: dict[str, Any] = {
        key: table.beside(base) for key, table in devices.items() if isinstance(table, DeviceTable)
    }
    further = devices.get("devices", {})
    found["devices"] = {
        name: table.beside(base) for name, table in further.items() if isinstance(table, DeviceTable)
    }
    return found


def _model_of(data: dict[str, Any], base: Path) -> Path | None:
    """The model file that the contents of a bench file name: beside it, or a shipped one."""
    simulation = data.get("simulation")
    model = simulation.get("model") if isinstance(simulation, dict) else None
    if not isinstance(model, str) or not model or not is_printable(model):
        return None
    try:
        return shipped_file(model, "model", base)
    except BadInputError:  # reported among the bench file's other mistakes
        return base / model


def _refuse(where: str, mistakes: list[str], text: str) -> None:
    refuse(where, map(keyed, mistakes), text, _FIX)


def _is_of(mistakes_of: str, of_devices: list[str]) -> bool:
    """Whether it is of a device's table that has mistakes: its kind has reported them."""
    wrong = {_device(keyed(mistake).key) for mistake in of_devices}
    return _device(keyed(mistakes_of).key) in wrong


def _device(key: str) -> str:
    """The device's table that a key stands in."""
    parts = key.split(".")
    return ".".join(parts[: 2 if parts[0] == "devices" else 1])


def _shipped_bench(name: str) -> Path:
    path = shipped(f"{name}.toml")
    try:
        if path.is_file():
            return path
    except (OSError, ValueError):  # no file can have such a name
        pass
    shipped_ones = did_you_mean(name, shipped_benches())
    raise BadInputError(
        f"there is no bench '{printable(name)}'",
        fix=f"{shipped_ones}; or give a file whose name ends in .toml",
    )


def shipped_benches() -> tuple[str, ...]:
    """Names of the shipped bench files."""
    files = shipped("sim.toml").parent.glob("*.toml")
    return tuple(sorted(path.stem for path in files if "[buses." in path.read_text("utf-8")))


def shipped(name: str) -> Path:
    """Path of a file of the shipped `benches`."""
    return Path(str(importlib.resources.files("benches"))) / name


OWN_BENCH = "bench.toml"


def found_bench(folders: Iterable[Path]) -> Path | None:
    """The bench file of the first of the folders that has one."""
    return next((folder / OWN_BENCH for folder in folders if is_file(folder / OWN_BENCH)), None)


def refuse_hardware(found: Path, option: str = "--bench") -> None:
    """Refuse to drive hardware that no one has named.

    Raises:
        BadInputError: the bench file that was found describes hardware, or cannot be used.
    """
    if load_bench(found).simulation is None:
        raise BadInputError(
            "describes hardware, which is driven only if it is named",
            where=str(found),
            fix=f"{option} {found} drives it; {option} sim is the simulated bench",
        )


def folders_of(plan: str | Path | None) -> list[Path]:
    """Where a bench file is looked for: beside the plan's file, then in the current folder."""
    beside = [Path(plan).parent] if plan is not None and is_file(Path(plan)) else []
    return [*beside, Path()]


def bench_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a bench file, with the kinds of device of all installed packages.

    A bench that `load_bench` takes is valid; what one key says about another, and what stands in the files
    that are named, only `load_bench` checks.
    """
    definitions: dict[str, Any] = {}
    schema = _schema_of(BenchFile, definitions)
    for key in LOADED:
        schema["properties"].pop(key)
    kinds = {}
    for kind in KINDS.names():
        table = KINDS.find(kind)
        if table is not None:
            kinds[kind] = _schema_of(table, definitions)
    for key, default in DEFAULT_KINDS.items():
        schema["properties"][key] = _by_kind(kinds, default)
    schema["properties"]["devices"]["additionalProperties"] = _by_kind(kinds, "")
    definitions["Day"] = {"type": "string", "format": "date", "description": "last valid day, as 2027-06-30"}
    schema["properties"]["calibration"]["additionalProperties"] = {"$ref": "#/$defs/Day"}
    return {"$schema": DRAFT, **schema, "title": "Bench file", "$defs": definitions}


def _by_kind(kinds: dict[str, dict[str, Any]], default: str) -> dict[str, Any]:
    """A device's table: its `kind` says which keys it has; without one it is of the kind `default`."""
    variants = []
    for kind, schema in kinds.items():
        named = {"properties": {"kind": {"const": kind}}}
        required = [key for key in schema.get("required", []) if key != "kind"]
        variants.append(
            {
                "if": named if kind == default else {**named, "required": ["kind"]},
                "then": {
                    "properties": schema["properties"],
                    "required": required,
                    "additionalProperties": False,
                },
            }
        )
    names: dict[str, Any] = {"enum": list(kinds)}
    table: dict[str, Any] = {"type": "object", "properties": {"kind": names}, "allOf": variants}
    if default:
        names["default"] = default
    else:
        table["required"] = ["kind"]
    return table


def _schema_of(model: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    """A table's schema; tables within it move to `definitions`."""
    schema = model.model_json_schema()
    definitions |= schema.pop("$defs", {})
    return schema
