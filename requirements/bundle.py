"""Puts into the wheel what is not in the repository: plotly.js with its licence, and the built page."""

from __future__ import annotations

from importlib import metadata, resources
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_PLOTLY = "reports/templates"
_PAGE = "hil/service/frontend/built"


class Bundle(BuildHookInterface[Any]):
    """Not for an editable install: there the package of plotly and the folder of the page are at hand."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name what goes where. A page that was not built stays out; `make release` refuses such a wheel."""
        if version == "editable":
            return
        script = resources.files("plotly").joinpath("package_data/plotly.min.js")
        licences = [file for file in metadata.files("plotly") or () if file.name.startswith("LICENSE")]
        build_data["force_include"] |= {
            str(script): f"{_PLOTLY}/plotly.min.js",
            str(licences[0].locate()): f"{_PLOTLY}/plotly.min.js.LICENSE.txt",
        }
        built = Path(self.root) / _PAGE
        for file in sorted(built.rglob("*")):
            if file.is_file():
                build_data["force_include"][str(file)] = f"{_PAGE}/{file.relative_to(built).as_posix()}"
