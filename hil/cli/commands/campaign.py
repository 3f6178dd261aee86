"""`hil campaign`: many simulations of a plan."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

from hil.app.campaign import CampaignStopped, forecast_campaign, run_campaign
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.requests import CampaignRequest
from hil.cli.inputs import request_of
from hil.cli.options.controllers import Campaign
from hil.cli.output import TERMINAL, print_json
from hil.cli.streams import complain
from hil.core.errors import BadInputError
from reports.outputs.campaign import passed, text_of


def execute(options: Campaign) -> int:
    """Execute the command; its exit code."""
    if options.server:
        _refuse_here_only(workers=options.workers, scheduler=options.scheduler, dry_run=options.dry_run)
        from hil.cli.remote_campaign import RemoteCampaign  # costs a campaign here nothing

        return RemoteCampaign(options.server, options.campaign, options.resume, options.overwrite).execute(
            options.out, as_json=options.json_
        )
    _refuse_together(
        options.out, options.workers, options.scheduler, resume=options.resume, overwrite=options.overwrite
    )
    request = request_of(CampaignRequest, options)
    if options.dry_run:
        forecast = forecast_campaign(request, TERMINAL)
        if options.json_:
            print_json(forecast)
        else:
            print(_forecast_in_words(forecast))
        return 0
    outcome = run_campaign(request, TERMINAL)
    if isinstance(outcome, CampaignStopped):
        INTERRUPTS.tell()
        command = shlex.join(["hil", "campaign", options.campaign, "--out", str(outcome.folder), "--resume"])
        complain("note", f"{outcome.done} of {outcome.of} simulations are kept; continue with: {command}")
        return EXIT_CODE
    found, wanted = outcome.found.findings, outcome.found.setting.file.pass_share
    if options.json_:
        print_json(outcome.summary)
    else:
        print(text_of(found, random=outcome.found.random, wanted=wanted, out=str(outcome.folder)))
    return int(passed(found, wanted) is False)


def _refuse_here_only(**options: object) -> None:
    """Who simulates is the service's to say.

    Raises:
        BadInputError: names the option.
    """
    for name, value in options.items():
        if value is not None and value is not False and value != "":
            option = f"--{name.replace('_', '-')}"
            raise BadInputError(f"{option} does not go with --server", where=option, fix="leave it out")


def _refuse_together(
    out: Path | None, workers: int | None, scheduler: str, *, resume: bool, overwrite: bool
) -> None:
    """Raises:
    BadInputError: an option without the one that it goes with, or beside one that it does not go with.
    """
    if scheduler and workers is not None:
        raise BadInputError("--workers does not go with --scheduler", where="--workers", fix="leave one out")
    if resume and out is None:
        raise BadInputError(
            "--resume goes with --out", where="--resume", fix="name the directory to continue with --out"
        )
    if resume and overwrite:
        raise BadInputError("--overwrite does not go with --resume", where="--resume", fix="leave one out")


def _forecast_in_words(forecast: dict[str, Any]) -> str:
    parts = [f"{count} values of {name}" for name, count in forecast["varied"].items()]
    if forecast["controllers"] > 1:
        parts.append(f"{forecast['controllers']} controllers")
    if forecast["draws"]:
        parts.append(f"{forecast['draws']} cars")
    minutes, seconds = divmod(round(forecast["duration_s"]), 60)
    return (
        f"{forecast['campaign']}: {forecast['simulations']} simulations ({' × '.join(parts) or 'one'}); "
        f"{1000 * forecast['one_s']:.0f} ms each, about {minutes} min {seconds} s on {forecast['processes']} "
        "processes"
    )
