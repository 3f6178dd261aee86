"""`hil init`: a folder of one's own, ready to run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.options._shared import JsonObject


@dataclass(frozen=True, kw_only=True)
class Init:
    """Make a folder with a plan, a simulated bench, its model and a controller.

    `hil check`, `hil run` and `pytest` work in it at once; its README.md says how. --samples adds the files
    for the how-to on diagnosis: axle.toml, chirp_high.csv, chirp_low.csv, steps.csv, multisine.csv.
    """

    folder: Annotated[Path, typer.Argument(metavar="DIR", help="a new folder, or an empty one")]
    samples: Annotated[
        bool,
        typer.Option("--samples", help="add recordings of an axle with backlash, to try a diagnosis"),
    ] = False
    as_json: JsonObject = False
