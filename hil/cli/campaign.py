"""`hil campaign`: many simulations of a plan."""

from __future__ import annotations

import contextlib
import os
import shlex
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hil.analysis.campaigns import Findings, column_units, findings_of
from hil.campaign import (
    BEGUN,
    FOLDER,
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
from hil.campaign import carry_out as simulate
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._output import print_json, progress, to_json
from hil.cli._results_folder import ResultsFolder, results_in
from hil.cli._second_interrupt import at_once
from hil.cli._streams import complain
from hil.cli.commands.campaign import Campaign
from hil.core.errors import BadInputError
from hil.engine import StopRequest
from reports import HTML, PDF
from reports.campaign_report import campaign_page
from reports.origin import origin_of
from reports.outputs.campaign import passed, summary_of, text_of
from reports.parts import documents

SUMMARY = "campaign.json"


def carry_out(options: Campaign) -> int:
    """Carry the command out; its exit code."""
    if options.server:
        _refuse_here_only(workers=options.workers, scheduler=options.scheduler, dry_run=options.dry_run)
        from hil.cli._remote_campaign import RemoteCampaign  # costs a campaign here nothing

        return RemoteCampaign(options.server, options.campaign, options.resume, options.overwrite).carry_out(
            options.out, as_json=options.json_
        )
    _refuse_together(
        options.out, options.workers, options.scheduler, resume=options.resume, overwrite=options.overwrite
    )
    setting = load_setting(options.campaign)
    simulations = Simulations(setting)
    processes = len(os.sched_getaffinity(0)) if options.workers is None else options.workers
    if options.dry_run:
        with progress(f"campaign {setting.file.name}"):
            forecast = _forecast(simulations, max(1, processes))
        if options.json_:
            print_json(forecast)
        else:
            print(_forecast_in_words(forecast))
        return 0
    with results_in(
        options.out,
        (BEGUN, SUMMARY, HTML, PDF),
        inputs=[one.path for one in setting.sources],
        overwrite=options.overwrite or options.resume,
        default="campaign",
        summary=SUMMARY,
    ) as place:
        if not _simulated(
            simulations, place, processes, options.scheduler, options.campaign, resume=options.resume
        ):
            return EXIT_CODE
        with progress(f"campaign {setting.file.name}") as show:
            show("report")
            found = _findings(setting, simulations, place)
            summary = _write(setting, found, place)
        wanted, random = setting.file.pass_share, setting.file.draws > 0
        if options.json_:
            print_json(summary)
        else:
            print(text_of(found, random=random, wanted=wanted, out=str(place.folder)))
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


def _simulated(
    simulations: Simulations,
    place: ResultsFolder,
    processes: int,
    scheduler: str,
    campaign: str,
    *,
    resume: bool,
) -> bool:
    """Carry out what is missing; False if somebody stopped it, which is told."""
    setting = simulations.setting
    stop = StopRequest()
    with progress(f"campaign {setting.file.name}") as show, stop.by_signals(), stop.telling(at_once(stop)):
        show("reading finished simulations")
        batch = begun_batch(place.folder, setting) if resume else 0
        if not batch:
            show("trying one")
            batch = batch_size(len(setting.cases), _one_s(simulations), max(1, processes))
            _begin(place, setting, batch)
        parts = Parts(place.folder, setting, simulations.drawn, batch)

        def tell(done: Progress) -> None:
            show(str(done), done.done / done.of)

        whole = not parts.missing()
        if not whole:
            with _carriers(simulations, processes, scheduler) as carriers:
                asked = (parts, carriers, simulations.failed)
                whole = simulate(*asked, show=tell, stopped=lambda: stop.times > 0)
    if not whole:
        done = len(setting.cases) - sum(len(batch) for batch in parts.missing())
        INTERRUPTS.tell()
        command = shlex.join(["hil", "campaign", campaign, "--out", str(place.folder), "--resume"])
        complain("note", f"{done} of {len(setting.cases)} simulations are kept; continue with: {command}")
    return whole


def _begin(place: ResultsFolder, setting: Setting, batch: int) -> None:
    """Earlier results go before anything of this campaign is there: never do both lie side by side."""
    place.remove_stale()
    for path in (place.folder / FOLDER).glob("part-*.parquet"):
        path.unlink()
    write_begun(place.folder, setting, batch)


@contextlib.contextmanager
def _carriers(simulations: Simulations, processes: int, scheduler: str) -> Iterator[Carriers]:
    if not scheduler and processes == 0:
        yield Here(simulations.rows)
        return
    from hil.campaign.on_dask import Workers, rows_of  # half a second

    with Workers(rows_of(simulations.setting), processes, scheduler) as workers:
        yield workers


def _one_s(simulations: Simulations) -> float:
    """Seconds of one simulation; a first one brings in what each process needs once."""
    count = len(simulations.setting.cases)
    simulations.row(0)
    begun_s = time.perf_counter()
    simulations.row(count - 1)
    return time.perf_counter() - begun_s


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
    listed = sorted([BEGUN, SUMMARY, HTML, PDF])
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
    files[BEGUN] = (place.folder / BEGUN).read_bytes()
    files[SUMMARY] = (to_json(summary) + "\n").encode()
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
