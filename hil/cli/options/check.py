"""`hil check`: everything that can be known of a plan before a bench is touched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from hil.cli.options._shared import BenchName, Controllers, JsonObject, PlanName

SEVERAL = ("--controller", "--set")


@dataclass(frozen=True, kw_only=True)
class Check:
    """Validate a plan; predict its duration, peaks and criteria; compare them with the limits.

    Exit code: 0 the plan fits the bench, 1 a predicted peak exceeds a limit, 2 the plan cannot be run. A
    criterion that is predicted to fail is reported and does not change the exit code.
    """

    plan: PlanName
    bench: BenchName = ""
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="value of a variable of the plan",
        ),
    ] = None
    controller: Controllers = None
    as_json: JsonObject = False
