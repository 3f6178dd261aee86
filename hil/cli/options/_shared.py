"""Options that several commands have in the same words."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_bench, shipped_model, shipped_plan


def found_model(given: Path | None) -> Path | None:
    """The file of a model that is given by path or by a shipped one's name; for options of typer."""
    from hil.core.files.shipped import shipped_file  # what only asks for help does without it

    return None if given is None else shipped_file(given, "model")


def found_targets(given: Path | None) -> Path | None:
    """Likewise of a targets file."""
    from hil.core.files.shipped import shipped_file

    return None if given is None else shipped_file(given, "targets file")


_OWN_BENCH = "default: bench.toml beside the plan or here, else sim"

PlanName = Annotated[
    str,
    typer.Argument(
        help="plan file, or the name of a shipped plan (`hil list plans`): acceptance, identification, …",
        autocompletion=shipped_plan(),
    ),
]
BenchName = Annotated[
    str,
    typer.Option(
        help=f"bench file, or the name of a shipped bench; {_OWN_BENCH}", autocompletion=shipped_bench()
    ),
]
DefaultBenchArgument = Annotated[
    str,
    typer.Argument(
        help=f"bench file, or the name of a shipped bench; {_OWN_BENCH}", autocompletion=shipped_bench()
    ),
]
BenchArgument = Annotated[
    str, typer.Argument(help="bench file, or the name of a shipped bench", autocompletion=shipped_bench())
]
SimulatedBenchName = Annotated[
    str, typer.Option(help=f"simulated bench, by file or name; {_OWN_BENCH}", autocompletion=shipped_bench())
]
ModelOption = Annotated[
    Path,
    typer.Option(
        "--model",
        help="model file, or the name of a shipped model (`hil list models`)",
        callback=found_model,
        autocompletion=shipped_model(),
    ),
]
Controllers = Annotated[
    list[str] | None,
    typer.Option(
        metavar="[NAME=]FILE",
        help="controller file to use instead of the plan's; NAME selects which one if the plan has several",
    ),
]
Operator = Annotated[str, typer.Option(help="name of the person who runs the bench; printed in the report")]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--columns",
        metavar="FILE.toml|CHANNEL=COLUMN",
        help="which column of another tool's file is which channel: a TOML file, or "
        "'motor_speed_rad_s=n_EM, unit=rpm, sign=-1' (also scale, offset, gear, wraps, missing, derivative; "
        "'time_s=, every_s=0.001'); repeatable",
    ),
]
JsonObject = Annotated[bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")]
OverwriteFile = Annotated[bool, typer.Option("--overwrite", help="replace the file in --out")]
OverwriteResult = Annotated[bool, typer.Option("--overwrite", help="replace an earlier result in --out")]
