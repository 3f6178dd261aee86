"""`hil campaign`: many simulations of a plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_campaign
from hil.cli._lean_imports import import_python_can


def command(
    campaign: Annotated[
        str,
        typer.Argument(
            help="campaign file, or the name of a shipped one: robustness", autocompletion=shipped_campaign()
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(help="directory for the results; default: out/campaign-NNN")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=1024,
            help="processes of this machine; 0: this one alone; default: one for each core",
        ),
    ] = None,
    scheduler: Annotated[
        str,
        typer.Option(metavar="ADDRESS", help="of dask.distributed, whose workers are used in their place"),
    ] = "",
    server: Annotated[
        str,
        typer.Option(
            metavar="URL", help="have a bench service carry it out (hil serve); the token is in HIL_TOKEN"
        ),
    ] = "",
    resume: Annotated[
        bool, typer.Option("--resume", help="go on in --out: only what is missing is simulated")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="say how many simulations and how long, and write nothing")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace an earlier result in --out")
    ] = False,
    json_: Annotated[
        bool, typer.Option("--json", help="print campaign.json on stdout, nothing else")
    ] = False,
) -> int:
    """Simulate a plan many times: parameters varied, cars drawn around the model, controllers compared.

    Writes simulations/ (Parquet, one row for each), campaign.json, report.html and report.pdf. Ctrl-C awaits
    what is under way, a few seconds, and keeps it; a second one does not. --resume goes on, also after a kill
    of this command, of a worker or of the scheduler: nothing is lost, nothing stands twice.

    Exit code: 0 done, and each controller passes as often as the file's pass_share wants, 1 one does not, 3
    nobody could carry it out: what was done is kept.
    """
    import_python_can()
    from hil.cli.campaign import carry_out

    return carry_out(
        campaign=campaign,
        out=out,
        workers=workers,
        scheduler=scheduler,
        server=server,
        resume=resume,
        dry_run=dry_run,
        overwrite=overwrite,
        json_=json_,
    )
