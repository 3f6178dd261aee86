"""`hil explain`: what would bring a predicted run to target figures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_model
from hil.cli.options._shared import OverwriteResult, SimulatedBenchName, found_model, found_targets


@dataclass(frozen=True, kw_only=True)
class Explain:
    """Search for model changes, one effect or two, with which a predicted run reproduces target values.

    Writes targets.json, rival_1.toml and further models, separating_plan.yaml, report.html and report.pdf.
    Ctrl-C ends the search and keeps the results so far. Exit code: 0 a rival meets every condition, 1 none
    does.
    """

    targets: Annotated[
        Path | None,
        typer.Argument(
            help="targets file (TOML), or the name of a shipped one: paper_targets", callback=found_targets
        ),
    ] = None
    target: Annotated[
        list[str] | None,
        typer.Option("--target", metavar="ID=VALUE", help="target value of a criterion; may be repeated"),
    ] = None
    plan: Annotated[
        str | None, typer.Option(help="plan file or name; default: the targets file's, or acceptance")
    ] = None
    bench: SimulatedBenchName = ""
    model: Annotated[
        Path | None,
        typer.Option(
            help="model file, or the name of a shipped model; default: the bench's",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ] = None
    among: Annotated[
        list[str] | None,
        typer.Option(
            "--among",
            metavar="ID",
            help="search only this effect, or 'controller'; may be repeated",
        ),
    ] = None
    evaluations: Annotated[int, typer.Option(min=20, max=100_000, help="number of predicted runs")] = 2000
    seed: Annotated[int, typer.Option(min=0, help="random seed of the starting points")] = 0
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/explain-NNN")] = (
        None
    )
    overwrite: OverwriteResult = False
    as_json: Annotated[bool, typer.Option("--json", help="print targets.json on stdout, nothing else")] = (
        False
    )
