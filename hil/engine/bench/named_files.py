"""The files that a bench file names: of its devices, and the model of a simulated bench."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drivers import DeviceTable
from hil.engine.bench.device_kinds import device_tables


def named_files(data: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Key and value of each, as they stand in the contents of a bench file; nothing is opened."""
    tables, _ = device_tables(data)
    further = tables.pop("devices", {})
    for key, table in {**tables, **{f"devices.{name}": table for name, table in further.items()}}.items():
        if isinstance(table, DeviceTable):
            yield from ((f"{key}.{field}", str(value)) for field, value in table if isinstance(value, Path))
    simulation = data.get("simulation")
    model = simulation.get("model") if isinstance(simulation, dict) else None
    if isinstance(model, str):
        yield "simulation.model", model
