"""`hil schema`: for editors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from hil.cli.completion import one_of


@dataclass(frozen=True, kw_only=True)
class Schema:
    """Print the JSON schema of plan, bench, model, controller or campaign files.

    Editors complete and check with it: yaml-language-server for plans and campaigns, Taplo (Even Better
    TOML) for the rest.
    """

    kind: Annotated[
        str,
        typer.Argument(
            help="kind of file: plan, bench, model, controller or campaign",
            autocompletion=one_of("plan", "bench", "model", "controller", "campaign"),
        ),
    ] = "plan"
