"""Options that several commands have in the same words."""

from __future__ import annotations

from typing import Annotated

import typer

from hil.cli._completion import shipped_bench, shipped_plan

PlanName = Annotated[
    str,
    typer.Argument(
        help="plan file, or the name of a shipped plan (`hil list plans`): acceptance, identification, …",
        autocompletion=shipped_plan(),
    ),
]
BenchName = Annotated[
    str, typer.Option(help="bench file, or the name of a shipped bench", autocompletion=shipped_bench())
]
BenchArgument = Annotated[
    str, typer.Argument(help="bench file, or the name of a shipped bench", autocompletion=shipped_bench())
]
SimulatedBenchName = Annotated[
    str, typer.Option(help="simulated bench, by file or name", autocompletion=shipped_bench())
]
Controllers = Annotated[
    list[str] | None,
    typer.Option(
        metavar="[NAME=]FILE",
        help="controller file to use instead of the plan's; NAME selects which one if the plan has several",
    ),
]
Operator = Annotated[str, typer.Option(help="name of the person who runs the bench; printed in the report")]
