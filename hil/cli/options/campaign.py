"""`hil campaign`: many simulations of a plan."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_campaign
from hil.cli.options._shared import OverwriteResult


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """Simulate a plan many times: vary parameters, sample vehicles around the model, compare controllers.

    Writes simulations/ (Parquet, one row per simulation), campaign.json, report.html and report.pdf. Ctrl-C
    waits a few seconds for simulations under way and keeps them; a second Ctrl-C does not wait. --resume
    continues, also after a kill of this command, of a worker or of the scheduler. No simulation is lost or
    stored twice.

    Exit code: 0 done, each controller reaches the file's pass_share, 1 one does not, 3 no worker could
    continue; finished simulations are kept.
    """

    campaign: Annotated[
        str,
        typer.Argument(
            help="campaign file, or the name of a shipped one: robustness", autocompletion=shipped_campaign()
        ),
    ]
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/campaign-NNN")] = (
        None
    )
    workers: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=1024,
            help="worker processes on this machine; 0: none, simulate in this process; default: one per core",
        ),
    ] = None
    scheduler: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="address of a dask.distributed scheduler; use its workers instead"
        ),
    ] = ""
    server: Annotated[
        str,
        typer.Option(metavar="URL", help="run it on a bench service (hil serve); HIL_TOKEN holds the token"),
    ] = ""
    resume: Annotated[
        bool, typer.Option("--resume", help="continue in --out; simulate only what is missing")
    ] = False
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="print the number of simulations and the duration; write nothing"),
    ] = False
    overwrite: OverwriteResult = False
    json_: Annotated[bool, typer.Option("--json", help="print campaign.json on stdout, nothing else")] = False
