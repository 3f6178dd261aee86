"""`hil bench doctor`: what of a bench is there, what is wrong with it, and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from hil.cli.options._shared import DefaultBenchArgument, JsonObject


@dataclass(frozen=True, kw_only=True)
class BenchDoctor:
    """Check which devices are connected and answer; report faults and remedies.

    Listens first, then reads from every device. Writes nothing to a device and moves nothing. Exit code: 0 no
    fault (hints do not count), 1 faults were found, 2 the bench file cannot be used, 3 neither RMCU nor dynos
    answer.
    """

    bench: DefaultBenchArgument = ""
    for_s: Annotated[
        float, typer.Option("--for", metavar="SECONDS", help="time to listen before the devices are read")
    ] = 2.0
    as_json: JsonObject = False
