"""`hil list`: what there is to choose from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from hil.cli.completion import one_of
from hil.cli.options._shared import JsonObject


@dataclass(frozen=True, kw_only=True)
class List:
    """List built-in plans, benches, models and effects, or the steps, metrics and devices for files.

    Steps, metrics and devices of installed packages stand there too.
    """

    what: Annotated[
        str,
        typer.Argument(
            help="plans, benches, models, effects, steps, metrics or devices",
            autocompletion=one_of("plans", "benches", "models", "effects", "steps", "metrics", "devices"),
        ),
    ]
    as_json: JsonObject = False
