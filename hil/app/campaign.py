"""Many simulations of a plan: variables, drawn cars, controllers."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.analysis.campaigns import Findings, column_units, findings_of
from hil.app.feedback import LOGGED, Feedback
from hil.app.interrupts import end_at_second
from hil.app.requests import CampaignRequest
from hil.app.result_file import Outcome, json_file
from hil.app.results_folder import ResultsFolder, results_in
from hil.campaign import (
    FOLDER,
    STARTED,
    Carriers,
    Here,
    Parts,
    Progress,
    Setting,
    Simulations,
    batch_size,
    begun_batch,
    load_setting,
    write_begun,
)
from hil.campaign import execute as simulate
from hil.engine import StopRequest
from reports import HTML, PDF
from reports.campaign_report import campaign_page
from reports.origin import origin_of
from reports.outputs.campaign import summary_of
from reports.parts import documents

SUMMARY = "campaign.json"


@dataclass(frozen=True)
class CampaignStopped:
    """Somebody stopped it: how many of its simulations are kept, and where."""

    done: int
    of: int
    folder: Path


@dataclass(frozen=True)
class Simulated:
    """The findings of a campaign, with what it was asked for."""

    setting: Setting
    findings: Findings

    @property
    def random(self) -> bool:
        """Whether cars were drawn: shares are of a sample then."""
        return self.setting.file.draws > 0


def run_campaign(
    request: CampaignRequest, feedback: Feedback = LOGGED
) -> Outcome[Simulated] | CampaignStopped:
    """Simulate what is missing, and write table, summary and report.

    Raises:
        BadInputError: the campaign has mistakes, or `out` holds other results.
    """
    setting = load_setting(request.campaign)
    simulations = Simulations(setting)
    with results_in(
        request.out,
        (STARTED, SUMMARY, HTML, PDF),
        inputs=[one.path for one in setting.sources],
        overwrite=request.overwrite or request.resume,
        default="campaign",
        summary=SUMMARY,
    ) as place:
        done = _simulate_missing(simulations, place, request, feedback)
        if done < len(setting.cases):
            return CampaignStopped(done, len(setting.cases), place.folder)
        with feedback.progress(f"campaign {setting.file.name}") as show:
            show("report")
            found = _findings(setting, simulations, place)
            summary = _write(setting, found, place)
    return Outcome(Simulated(setting, found), summary, place.folder)


def forecast_campaign(request: CampaignRequest, feedback: Feedback = LOGGED) -> dict[str, Any]:
    """How many simulations a campaign has, and how long they take here: two of them are executed.

    Raises:
        BadInputError: the campaign has mistakes.
    """
    simulations = Simulations(load_setting(request.campaign))
    with feedback.progress(f"campaign {simulations.setting.file.name}"):
        return _forecast(simulations, request.processes)


def _simulate_missing(
    simulations: Simulations, place: ResultsFolder, request: CampaignRequest, feedback: Feedback
) -> int:
    """Execute what is missing; how many are there then: fewer than asked for if somebody stopped it."""
    setting, stop = simulations.setting, StopRequest()
    progress = feedback.progress(f"campaign {setting.file.name}")
    with progress as show, stop.by_signals(), stop.telling(end_at_second(stop)):
        show("reading finished simulations")
        batch = begun_batch(place.folder, setting) if request.resume else 0
        if not batch:
            show("trying one")
            batch = batch_size(len(setting.cases), _one_s(simulations), request.processes)
            _begin(place, setting, batch)
        parts = Parts(place.folder, setting, simulations.drawn, batch)

        def show_done(done: Progress) -> None:
            show(str(done), done.done / done.of)

        if parts.missing():
            with _carriers(simulations, request) as carriers:
                wanted = (parts, carriers, simulations.failed)
                simulate(*wanted, show=show_done, stopped=lambda: stop.times > 0)
    return len(setting.cases) - sum(len(batch) for batch in parts.missing())


def _begin(place: ResultsFolder, setting: Setting, batch: int) -> None:
    """Earlier results go before anything of this campaign is there: never do both lie side by side."""
    place.remove_stale()
    for path in (place.folder / FOLDER).glob("part-*.parquet"):
        path.unlink()
    write_begun(place.folder, setting, batch)


@contextlib.contextmanager
def _carriers(simulations: Simulations, request: CampaignRequest) -> Iterator[Carriers]:
    if not request.scheduler and request.workers == 0:
        yield Here(simulations.rows)
        return
    from hil.campaign.on_dask import Workers, rows_of  # half a second

    processes = request.processes
    with Workers(rows_of(simulations.setting), processes, request.scheduler) as workers:
        yield workers


def _one_s(simulations: Simulations) -> float:
    """Seconds of one simulation; a first one brings in what each process needs once."""
    count = len(simulations.setting.cases)
    simulations.row(0)
    start_s = time.perf_counter()
    simulations.row(count - 1)
    return time.perf_counter() - start_s


def _findings(setting: Setting, simulations: Simulations, place: ResultsFolder) -> Findings:
    batch = begun_batch(place.folder, setting)
    table = Parts(place.folder, setting, simulations.drawn, batch).table()
    return findings_of(table, setting.criteria, column_units(setting.cases.axes, simulations.drawn))


def _write(setting: Setting, found: Findings, place: ResultsFolder) -> dict[str, Any]:
    file = setting.file
    random = file.draws > 0
    asked = {
        "campaign": file.name,
        "title": file.title,
        "plan": setting.plan.name,
        "model": str(next(one.path for one in setting.sources if one.role == "model")),
        "bench": setting.bench.name,
        "draws": file.draws,
        "seed": file.seed,
        "table": FOLDER,
    }
    listed = sorted([STARTED, SUMMARY, HTML, PDF])
    summary = summary_of(found, asked, random=random, wanted=file.pass_share, files=listed)
    used: dict[str, list[Path]] = {}
    for one in setting.sources:
        used.setdefault(one.role, []).append(one.path)
    page = campaign_page(
        found,
        file.title or file.name,
        file.description,
        origin_of(used),
        random=random,
        wanted=file.pass_share,
    )
    files = documents(page)
    files[STARTED] = (place.folder / STARTED).read_bytes()
    files[SUMMARY] = json_file(summary)
    place.write(files, [one.path for one in setting.sources])
    return summary


def _forecast(simulations: Simulations, processes: int) -> dict[str, Any]:
    setting = simulations.setting
    one_s = _one_s(simulations)
    count = len(setting.cases)
    return {
        "campaign": setting.file.name,
        "simulations": count,
        "varied": {axis.column: len(axis.values) for axis in setting.cases.axes},
        "controllers": len(setting.controllers),
        "draws": setting.file.draws,
        "one_s": one_s,
        "processes": processes,
        "duration_s": count * one_s / processes,
    }
