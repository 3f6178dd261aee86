"""Puts plotly.js and its licence, out of the plotly package, into the wheel."""

from __future__ import annotations

from importlib import metadata, resources
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_PLACE = "reports/templates"


class BundlePlotly(BuildHookInterface[Any]):
    """Not for an editable install: there the package itself is at hand."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name what goes where."""
        if version == "editable":
            return
        script = resources.files("plotly").joinpath("package_data/plotly.min.js")
        licences = [file for file in metadata.files("plotly") or () if file.name.startswith("LICENSE")]
        build_data["force_include"] |= {
            str(script): f"{_PLACE}/plotly.min.js",
            str(licences[0].locate()): f"{_PLACE}/plotly.min.js.LICENSE.txt",
        }
