"""The table of floors is that of the import layers."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
_ROW = re.compile(r"^\| (\d+) \| `([\w.]+)` \|", re.MULTILINE)


def test_every_package_stands_on_the_floor_of_its_layer() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    (layers,) = [one["layers"] for one in contracts if one["name"] == "Imports point down only"]
    floors = {name: floor for floor, layer in enumerate(reversed(layers)) for name in layer.split(" | ")}
    page = (ROOT / "docs/explanation/architecture.md").read_text("utf-8")
    assert {name: int(floor) for floor, name in _ROW.findall(page)} == floors
