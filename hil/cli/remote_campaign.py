"""`hil --server URL campaign`: a campaign that a bench service executes, its results brought here."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hil.analysis.campaigns import CampaignFile, Share, load_campaign_file
from hil.api_schemas.campaign import CAMPAIGN_OVER, TABLE, CampaignData, CampaignWanted
from hil.app.interrupts import EXIT_CODE
from hil.app.results_folder import ResultsFolder, results_in
from hil.campaign import FOLDER, STARTED
from hil.cli.output import print_json, progress
from hil.cli.remote_run import TOKEN
from hil.cli.streams import complain
from hil.client import Client, RefusedError
from hil.client.retry import OURS, Retry
from hil.core.errors import BadInputError, BenchError, InterruptError
from hil.core.files import is_file, make_directory, read_text, write_atomically
from hil.engine import StopRequest
from hil.execution.data_folder import files_of
from reports import HTML, PDF
from reports.outputs.campaign import OWN, share_in_words
from test_plans import load_plan

SUMMARY = "campaign.json"
_GO_ON = "continue it with --resume"
_LOOK_S = 0.5


@dataclass(frozen=True)
class RemoteCampaign:
    """What is wanted of a service; `campaign` is a file, or a built-in one by its name.

    `resume`: of what the service has of the same content, the newest is gone on with.
    """

    server: str
    campaign: str
    resume: bool
    overwrite: bool

    def execute(self, out: Path | None, *, as_json: bool) -> int:
        """Have it executed and bring its files here; its exit code."""
        client, stop = Client(self.server, os.environ.get(TOKEN, "")), StopRequest()
        wanted = _wanted(load_campaign_file(self.campaign))
        names = (STARTED, SUMMARY, HTML, PDF)
        overwrite = self.overwrite or self.resume
        with (
            results_in(out, names, overwrite=overwrite, default="campaign", summary=SUMMARY) as place,
            stop.by_signals(),
        ):
            found = _Watching(client, self._queue(client, wanted), stop).until_over()
            if found.state == "cancelled":
                complain("note", f"{found.done} of {found.simulations} simulations are kept: {_GO_ON}")
                return EXIT_CODE
            if found.state == "failed":
                raise BenchError(
                    found.reason,
                    where=f"campaign {found.id} of the service",
                    fix=f"finished simulations are kept: {_GO_ON}",
                )
            summary = _brought(client, found, place)
            if as_json:
                print_json(summary)
            else:
                print(_in_words(found, place.folder))
        return int(found.passed is False)

    def _queue(self, client: Client, wanted: CampaignWanted) -> CampaignData:
        """The campaign as the service has it.

        Raises:
            BadInputError: the service refuses it, or has none to go on with.
            BenchError: the service cannot be reached.
        """
        try:
            if not self.resume:
                return client.add_campaign(wanted)
            same = [one for one in client.campaigns() if one.digest == wanted.digest and not one.place]
            if not same:
                raise BadInputError(
                    "the service has no campaign of this content", where="--resume", fix="leave it out"
                )
            newest = same[0]
            return client.resume_campaign(newest.id) if newest.state in ("cancelled", "failed") else newest
        except RefusedError as error:
            if error.status in OURS:
                raise BadInputError(error.what, where=error.where, fix=error.fix) from error
            raise


def _wanted(file: CampaignFile) -> CampaignWanted:
    """The campaign with the files beside it; what is not there, the service may have.

    Raises:
        BadInputError: a file cannot be read, or cannot be sent under its name.
    """
    files = {path.name: read_text(path) for path in _beside(file)}
    try:
        return CampaignWanted(text=file.text, files=files)
    except ValidationError as error:
        raise BadInputError(
            f"the service rejects it: {error.errors()[0]['msg']}",
            where=str(file.source),
            fix="limits: 200 kB, and file names without path that end in .yaml or .toml",
        ) from None


def _beside(file: CampaignFile) -> Iterator[Path]:
    named = [file.plan, *([file.model] if file.model else [])]
    named += [name if name.endswith(".toml") else f"{name}.toml" for name in file.controllers]
    for name in named:
        path = file.beside(name)
        if path is None:
            continue
        if path != file.source.parent / path.name:
            raise BadInputError(
                f"'{name}' is in another folder", where=str(file.source), fix="put it beside the campaign"
            )
        yield path
        if name == file.plan:
            yield from (one for one in files_of(load_plan(path)) if _lies_beside(one, path))


def _lies_beside(path: Path, plan: Path) -> bool:
    return path.parent.resolve() == plan.parent.resolve() and is_file(path)


@dataclass
class _Watching:
    """Follows a campaign until it is over; Ctrl-C ends it there."""

    client: Client
    campaign: CampaignData
    stop: StopRequest
    told_stop: bool = False

    def until_over(self) -> CampaignData:
        """The campaign as it ended.

        Raises:
            BenchError: the service has not answered for a minute.
            InterruptError: somebody asked twice to stop.
        """
        retry, name = Retry(), f"campaign {self.campaign.id}: {self.campaign.name}"
        with progress(name) as show:
            while self.campaign.state not in CAMPAIGN_OVER:
                time.sleep(_LOOK_S)
                retry.ask(self._ask)
                show(*_progress(self.campaign))
        return self.campaign

    def _ask(self) -> None:
        number = self.campaign.id
        if self.stop.times > 1:
            raise InterruptError(f"interrupted; campaign {number} is being stopped by the service")
        if self.stop.times and not self.told_stop:
            self.told_stop = True
            self.campaign = self.client.cancel_campaign(number)
        else:
            self.campaign = self.client.campaign(number)


def _progress(campaign: CampaignData) -> tuple[str, float]:
    rate = f", {campaign.rate_hz:.1f}/s" if campaign.rate_hz else ""
    state = "" if campaign.state == "running" else f", {campaign.state}"
    share = campaign.done / max(1, campaign.simulations)
    return f"{campaign.done} of {campaign.simulations}{rate}{state}", share


def _brought(client: Client, campaign: CampaignData, place: ResultsFolder) -> dict[str, Any]:
    """Its files, here, as `hil campaign` leaves them, the table being one part; what `campaign.json` says."""
    table = place.folder / FOLDER
    make_directory(table)
    for path in table.glob("part-*.parquet"):
        path.unlink()
    part = f"part-{0:07d}-{campaign.simulations - 1:07d}.parquet"
    client.download_of_campaign(campaign.id, TABLE, table / part)
    for name in (STARTED, HTML, PDF, SUMMARY):
        client.download_of_campaign(campaign.id, name, place.folder / name)
    content = json.loads(read_text(place.folder / STARTED)) | {"batch": campaign.simulations}
    write_atomically(place.folder / STARTED, json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    found: dict[str, Any] = json.loads(read_text(place.folder / SUMMARY))
    place.remove_stale(found["files"])
    return found


def _in_words(campaign: CampaignData, folder: Path) -> str:
    lines = []
    for one in campaign.controllers:
        share = share_in_words(Share(one.passed, one.of), random=one.interval is not None)
        lines.append(f"{one.controller or OWN}: {share} pass")
    if campaign.pass_share_wanted is not None:
        reached = "reached" if campaign.passed else "not reached"
        lines.append(f"required pass rate {100 * campaign.pass_share_wanted:g} %: {reached}")
    lines.append(f"{campaign.done} simulations; in {folder}")
    return "\n".join(lines)
