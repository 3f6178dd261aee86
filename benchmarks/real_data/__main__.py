"""What `hil diagnose` says of measurements by others.

    python -m benchmarks.real_data --data DIR [NAME ...]

DIR holds a directory for each data set, named as it, with the files as published; those that are not there
are left out. docs/reference/real-data.md says where they come from.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.real_data.ced import CED
from benchmarks.real_data.dfki import DFKI
from benchmarks.real_data.embir import EMBIR
from benchmarks.real_data.emps import EMPS
from benchmarks.real_data.fditools import FDITOOLS
from benchmarks.real_data.hsm150 import HSM150
from benchmarks.real_data.lexium62 import LEXIUM62
from benchmarks.real_data.lorenz import LORENZ
from benchmarks.real_data.measured import SPEED, DataSet
from hil.core.errors import HilError
from hil.core.model import Model, save_model
from hil.core.recording import Recording, write_recording

DATA_SETS = {one.name: one for one in (EMPS, HSM150, LORENZ, LEXIUM62, EMBIR, DFKI, *FDITOOLS, CED)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Diagnose what is there and print a line for each start; 2 if nothing is there or a file is bad."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.real_data",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(DATA_SETS)}; all if none")
    parser.add_argument("--data", type=Path, required=True, help="directory with one directory a data set")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.names if name not in DATA_SETS]
    if unknown:
        parser.error(f"no data set {', '.join(unknown)}; there are {', '.join(DATA_SETS)}")
    wanted = [DATA_SETS[name] for name in options.names or DATA_SETS]
    here = [one for one in wanted if not missing(one, one.place(options.data))]
    for one in wanted:
        if one not in here:
            print(f"{one.name}: not in {one.place(options.data)}: {missing(one, one.place(options.data))[0]}")
    try:
        for one in here:
            _run(one, one.place(options.data))
    except HilError as error:
        print(error, file=sys.stderr)
        return 2
    return 0 if here else 2


def missing(one: DataSet, directory: Path) -> list[str]:
    """Files of a data set that are not there."""
    return [name for name in one.files if not (directory / name).is_file()]


def _run(one: DataSet, directory: Path) -> None:
    measured = one.read(directory)
    print(f"{one.name}; expected: {one.expected}")
    for name, start in measured.starts.items():
        print(f"  from {name}: {_told(*diagnosed(start, measured.recordings, measured.holdout))}", flush=True)


def diagnosed(
    start: Model, recordings: Sequence[Recording], holdout: Sequence[Recording]
) -> tuple[dict[str, Any], float]:
    """(diagnosis.json, or its `failure`; seconds) of `hil diagnose` in a process of its own."""
    with tempfile.TemporaryDirectory(prefix="real-data-") as place:
        model = Path(place) / "model.toml"
        save_model(start, model)
        command = [sys.executable, "-c", "from hil.cli import main; main()", "diagnose", "--json"]
        command += ["--model", str(model), "--out", str(Path(place) / "out")]
        command += [_written(r, Path(place) / f"fit_{i}.csv") for i, r in enumerate(recordings)]
        for i, recording in enumerate(holdout):
            command += ["--holdout", _written(recording, Path(place) / f"held_{i}.csv")]
        began = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        took = time.perf_counter() - began
    if done.returncode != 0:
        return {"failure": done.stderr.strip() or f"exit code {done.returncode}"}, took
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer, took


def _written(recording: Recording, path: Path) -> str:
    write_recording(recording, path)
    return str(path)


def _told(answer: dict[str, Any], took_s: float) -> str:
    """One line and one for each name: verdict, gaps in percent of the signal, parameters, seconds."""
    if "failure" in answer:
        return f"refused after {took_s:.0f} s: {answer['failure']}"
    gap, held = answer["gap"][SPEED], answer.get("holdout_gap", {}).get(SPEED)
    lines = [
        f"{answer['verdict']}, gap {_percent(gap)}"
        + (f", held out {_percent(held)}" if held else "")
        + f", {took_s:.0f} s"
    ]
    for effect in answer["effects"]:
        lines.append(f"      {effect['id']} ({effect['confidence']:.2f}): {_numbers(effect)}")
    if not answer["effects"]:
        rivals = ", ".join(f"{a['id']} ({a['confidence']:.2f})" for a in answer["alternatives"])
        lines.append(f"      or {rivals}" if rivals else "      no rival")
    found = {"start": (answer.get("start") or {}).get("parameters"), "updates": answer["parameter_updates"]}
    for key, changed in found.items():
        if not changed:
            continue
        told = ", ".join(f"{name} {_value(value)}" for name, value in changed.items())
        lines.append(f"      {key}: {told}")
    return "\n".join(lines)


def _percent(gap: dict[str, float]) -> str:
    before, after, noise = (100.0 * gap[name] for name in ("before", "after", "noise_floor"))
    return f"{before:.3g} -> {after:.3g} % (noise {noise:.2g} %)"


def _numbers(effect: dict[str, Any]) -> str:
    errors = effect.get("standard_error", {})
    return ", ".join(
        f"{name} {value}" if isinstance(value, str) else f"{name} {value:.4g}{_error(errors.get(name))}"
        for name, value in effect["parameters"].items()
    )


def _error(error: float | None) -> str:
    return f" ± {error:.2g}" if error else ""


def _value(value: Any) -> str:
    return f"{value['from']:.4g} -> {value['to']:.4g}" if isinstance(value, dict) else str(value)


if __name__ == "__main__":
    sys.exit(main())
