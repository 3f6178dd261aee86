"""`hil compare`: the same plan on several runs, side by side."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Compare runs of one plan: criteria, step responses overlaid, spectra.

    Writes comparison.json, report.html and report.pdf, all or none. The first run is the reference. To see
    where an augmented model improves, give the measured run first, then the base model, then the augmented
    one. Criteria are computed again from the recordings.
    """

    runs: Annotated[
        list[Path],
        typer.Argument(metavar="DIR...", help="run directories or recordings; the first is the reference"),
    ]
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/compare-NNN")] = (
        None
    )
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier comparison in --out")] = (
        False
    )
    as_json: Annotated[bool, typer.Option("--json", help="print comparison.json on stdout, nothing else")] = (
        False
    )
