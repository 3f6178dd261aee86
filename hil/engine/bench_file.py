"""Bench files: interfaces, devices, limits, calibration, DUT. A plan never names hardware."""

from __future__ import annotations

import difflib
import importlib.resources
import tomllib
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.mistakes import keyed, refuse
from hil.core.printable import printable
from hil.core.table_mistakes import told
from hil.engine._bench_checks import contradictions, device_mistakes, unprintable
from hil.engine.bench_tables import BenchFile
from hil.engine.device_kinds import device_tables

DEFAULT_BENCH = "sim"

_FIX = "see docs/how-to/bench-file.md"
_LOADED = ("text", "source")  # fields of the loaded bench that are no keys of the file


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
    unknown = [f"{key}: unknown key" for key in _LOADED if key in data]
    _refuse(where, [*unprintable(data), *unknown], text)
    devices, mistakes = device_tables(data)
    try:
        bench = BenchFile.model_validate({**data, **devices, "text": text, "source": path.resolve()})
    except ValidationError as error:
        further = told(error, BenchFile, known=mistakes)
        _refuse(where, [*mistakes, *(told for told in further if not _is_of(told, mistakes))], text)
        raise
    _refuse(where, mistakes or contradictions(bench), text)
    base = path.resolve().parent
    changes: dict[str, Any] = {
        "rmcu": bench.rmcu.beside(base),
        "dyno": bench.dyno.beside(base),
        "devices": {name: table.beside(base) for name, table in bench.devices.items()},
    }
    if bench.simulation:
        changes["simulation"] = bench.simulation.model_copy(update={"model": base / bench.simulation.model})
    loaded = bench.model_copy(update=changes)
    _refuse(where, device_mistakes(loaded), text)
    return loaded


def with_seed(bench: BenchFile, seed: int) -> BenchFile:
    """A simulated bench with another seed of its noise; its text says so."""
    data = tomllib.loads(bench.text)
    data["simulation"]["seed"] = seed
    return bench_from_dict(data, tomli_w.dumps(data), bench.source)


def _refuse(where: str, mistakes: list[str], text: str) -> None:
    refuse(where, map(keyed, mistakes), text, _FIX)


def _is_of(told: str, of_devices: list[str]) -> bool:
    """Whether it is of a device's table that has mistakes: its kind has told them."""
    wrong = {_device(keyed(mistake).key) for mistake in of_devices}
    return _device(keyed(told).key) in wrong


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
    near = difflib.get_close_matches(name, shipped_benches(), 1)
    hint = f"did you mean '{near[0]}'? " if near else ""
    raise BadInputError(
        f"there is no bench '{printable(name)}'",
        fix=f"{hint}shipped: {', '.join(shipped_benches())}; or give a file, whose name ends in .toml",
    )


def shipped_benches() -> tuple[str, ...]:
    """Names of the shipped bench files."""
    files = shipped("sim.toml").parent.glob("*.toml")
    return tuple(sorted(path.stem for path in files if "[buses." in path.read_text("utf-8")))


def shipped(name: str) -> Path:
    """Path of a file of the shipped `benches`."""
    return Path(str(importlib.resources.files("benches"))) / name
