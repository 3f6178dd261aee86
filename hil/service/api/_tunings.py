"""Tunings of controllers: on a model, and by a sequence of runs on a simulated bench."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
from pathlib import Path
from typing import Annotated, Any

import yaml
from fastapi import APIRouter, Body

from hil.api_schemas.api import RunId
from hil.api_schemas.study import StudyData, StudyKind
from hil.api_schemas.tuning import (
    AutotuningData,
    AutotuningPlanned,
    AutotuningWanted,
    EnvelopeData,
    ProgressData,
    TuningData,
    TuningWanted,
)
from hil.app.requests import AutotuneRequest, SearchRequest, TuneRequest
from hil.core.files import make_directory, write_atomically
from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.jobs.studies import StudyAsked
from hil.service.service import Service

router = APIRouter(tags=["tuning"])
_WRITTEN_WITHIN_S = 600.0  # a tuning, after the time that it may search
_SEQUENCE_WITHIN_S = 6 * 3600.0


@router.post("/tunings", name="tune", status_code=201)
async def tune(wanted: Annotated[TuningWanted, Body()], service: TheService, me: Engineer) -> StudyData:
    """Tune a plan's controller on a model, as `hil tune`; takes minutes."""
    search = SearchRequest(
        plan=_plan(service, wanted.plan),
        model=_model(service, wanted.model),
        bench=_bench(service, wanted.bench),
        controller=wanted.controller,
        draws=wanted.draws,
        seed=wanted.seed,
        may_worsen=tuple(wanted.may_worsen),
    )
    request = TuneRequest(
        search=search, starts=wanted.starts, at_most=wanted.at_most_min, processes=_processes()
    )
    asked = StudyAsked("tuning", [], [], wanted.model, me.name, wanted.plan, wanted.bench)
    found = service.studies.add(asked, request, 60 * wanted.at_most_min + _WRITTEN_WITHIN_S)
    service.log.add(me.name, me.role, "tuning", f"study {found.id}", f"{wanted.plan} on {wanted.model}")
    return found


@router.get("/tunings/{study}", name="get_tuning")
async def get_tuning(study: RunId, service: TheService, me: Viewer) -> TuningData:
    """Progress of a tuning, then the front of controllers and what was chosen."""
    del me
    of = _there(service, study, "tuning")
    progress = ProgressData(**service.studies.progress_of(study))
    found = await _written(service, of, "tune.json")
    if not found:
        return TuningData(study=of, progress=progress)
    same = ("worst_margin", "start_worst_margin", "ended", "parameters")
    return TuningData(
        study=of,
        progress=progress,
        figures=found["front"]["figures"],
        front=found["front"]["points"],
        worse=[_in_words(one) for one in found["worse"]],
        **{name: found[name] for name in same},
    )


@router.post("/autotunings/envelopes", name="plan_autotuning")
async def plan_autotuning(
    wanted: Annotated[AutotuningPlanned, Body()], service: TheService, me: Engineer
) -> EnvelopeData:
    """What a sequence would ask of its bench at most; nothing moves."""
    del me
    model, bench = str(_model(service, wanted.model)), _bench(service, wanted.bench)
    sequence = _written_sequence(wanted, service)
    try:
        found = await service.worker_pool.ask("envelope", sequence=str(sequence), model=model, bench=bench)
    finally:
        sequence.unlink(missing_ok=True)
    return EnvelopeData(bench=wanted.bench, **found)


@router.post("/autotunings", name="autotune", status_code=201)
async def autotune(
    wanted: Annotated[AutotuningWanted, Body()], service: TheService, me: Engineer
) -> StudyData:
    """Begin a sequence on a simulated bench, as `hil autotune`, within the envelope consented to."""
    model, bench = _model(service, wanted.model), _bench(service, wanted.bench)
    sequence = _written_sequence(wanted, service)
    request = AutotuneRequest(
        sequence=str(sequence),
        model=model,
        bench=bench,
        envelope={**wanted.largest, "bench_time_s": wanted.bench_time_s},
        confirm=wanted.confirm,
        operator=me.name,
        processes=_processes(),
    )
    asked = StudyAsked(
        "autotuning", [], [], wanted.model, me.name, wanted.plan, wanted.bench, sequence=sequence
    )
    try:
        found = service.studies.add(asked, request, _SEQUENCE_WITHIN_S)
    except BaseException:
        sequence.unlink(missing_ok=True)
        raise
    text = f"{wanted.plan} on {wanted.bench}, consented to by {wanted.confirm}"
    service.log.add(me.name, me.role, "autotuning", f"study {found.id}", text)
    return found


@router.get("/autotunings/{study}", name="get_autotuning")
async def get_autotuning(study: RunId, service: TheService, me: Viewer) -> AutotuningData:
    """Every decision of a sequence as it falls, and what it came to."""
    del me
    of = _there(service, study, "autotuning")
    found = await _written(service, of, "autotune.json")
    decisions = [
        {name: str(one[name]) if name != "round" else one[name] for name in _DECISION}
        for one in found.get("decisions", [])
    ]
    same = ("consent", "envelope", "ended", "worst_margin", "values")
    return AutotuningData(
        study=of,
        progress=ProgressData(**service.studies.progress_of(study)),
        decisions=decisions,
        **{name: found[name] for name in same if found.get(name) is not None},
    )


def _in_words(worse: dict[str, Any]) -> str:
    unit = f" {worse['unit']}" if worse["unit"] not in ("", "1") else ""
    return f"{worse['words']}: {worse['start']:.4g} → {worse['value']:.4g}{unit}"


_DECISION = ("round", "stage", "found", "decided", "why")


async def _written(service: Service, of: StudyData, name: str) -> dict[str, Any]:
    """What a study has written by now; {} before that."""
    path = service.studies.results(of.id) / name
    if of.place:
        path = await service.studies.file(of.id, name)
    with contextlib.suppress(OSError, ValueError):
        found: dict[str, Any] = json.loads(path.read_bytes())
        return found
    return {}


def _written_sequence(wanted: AutotuningPlanned, service: Service) -> Path:
    """A file of it, which whoever asked removes."""
    content = {
        "name": "autotune",
        "identify": _plan(service, wanted.identify),
        "accept": _plan(service, wanted.plan),
        "controller": wanted.controller,
        "rounds": wanted.rounds,
        "runs": wanted.runs,
        "draws": wanted.draws,
        "diagnose_minutes": wanted.diagnose_min,
    }
    folder = service.studies.sequences_folder()
    make_directory(folder)
    path = folder.resolve() / f"{secrets.token_hex(8)}.yaml"
    write_atomically(path, yaml.safe_dump(content, sort_keys=False))
    return path


def _processes() -> int:
    """One processor is left to runs."""
    return max(1, len(os.sched_getaffinity(0)) - 1)


def _plan(service: Service, name: str) -> str:
    if service.plans.get(name) is None:
        raise missing("plan", name)
    return str(service.plans.source(name).resolve())


def _model(service: Service, name: str) -> Path:
    path = service.models.path(name)
    if path is None:
        raise missing("model", name)
    return path.resolve()


def _bench(service: Service, name: str) -> str:
    """The file of a simulated bench: hardware is driven by the queue alone."""
    bench = service.own(name)
    if bench is None:
        raise missing("bench of this service", name)
    if not bench.simulated:
        fix = "use `hil tune --on-bench` or `hil autotune` where the bench is, or choose a simulated one"
        raise RefusedError(422, "is a bench on hardware", where=name, fix=fix)
    return str(bench.file.source.resolve())


def _there(service: Service, study: int, kind: StudyKind) -> StudyData:
    found = service.studies.get(study)
    if found is None or found.kind != kind:
        raise missing(kind, study)
    return found
