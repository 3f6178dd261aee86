"""Writes the unit: pythonfmu's binary, a script that calls this package, and the files that it reads."""

from __future__ import annotations

import importlib
import sys
import tempfile
from pathlib import Path
from typing import Any

from hil.core.controller import Controller
from hil.core.errors.extras import need
from hil.core.files import replacing
from hil.core.model import Model, model_to_toml
from hil.fmu.axle import Axle

_UNIT = Path(__file__).with_name("unit.py")


def export_fmu(model: Model, out: Path, controller: tuple[Controller, str] | None = None) -> None:
    """Write an FMI 2 co-simulation unit.

    Args:
        controller: with the text of its file.

    Raises:
        BadInputError: pythonfmu is not installed, or the model cannot be a unit.
        BenchError: the RMCU would refuse the controller, or the disk is full.
    """
    need("pythonfmu")
    builder: Any = importlib.import_module("pythonfmu")
    Axle(model, controller[0] if controller else None)  # what cannot be is reported now, not in another tool
    with tempfile.TemporaryDirectory() as directory, replacing(out) as temporary:
        folder = Path(directory)
        script = folder / "eaxle_unit.py"
        script.write_bytes(_UNIT.read_bytes())
        files = {"model.toml": model_to_toml(model)}
        if controller:
            files["controller.toml"] = controller[1]
        for name, text in files.items():
            (folder / name).write_text(text, "utf-8")
        before = list(sys.path)
        try:
            made = builder.FmuBuilder.build_FMU(
                script, dest=folder / "built", project_files=[folder / name for name in files],
                needsExecutionTool=True,
            )  # fmt: skip
        finally:
            sys.path[:] = before
            sys.modules.pop(script.stem, None)
        temporary.write_bytes(Path(made).read_bytes())
