"""Identifications and diagnoses of runs and of recordings that people gave."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Body, Query
from fastapi.responses import FileResponse
from starlette.responses import Response

from hil.api_schemas.api import OVER, Me, RunId
from hil.api_schemas.study import (
    STUDY_OVER,
    DiagnosisData,
    DiagnosisWanted,
    IdentificationData,
    IdentificationWanted,
    StudyData,
    StudyKind,
)
from hil.app.requests import DiagnoseRequest, IdentifyRequest
from hil.core.files import read_text
from hil.engine import RECORDING
from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._left_files import left_file
from hil.service.api._problems import RefusedError, missing, refuse_elsewhere
from hil.service.jobs.studies import StudyAsked
from hil.service.service import Service

router = APIRouter(tags=["studies"])
_IDENTIFIED_WITHIN_S = 600.0
_WRITTEN_WITHIN_S = 180.0  # a diagnosis, after the time that it may search


@router.post("/identifications", name="identify", status_code=201)
async def identify(
    wanted: Annotated[IdentificationWanted, Body()], service: TheService, me: Engineer
) -> StudyData:
    """Identify a model from runs, as `hil identify`; takes seconds to minutes."""
    files = await _files(service, wanted.runs, wanted.recordings)
    request = IdentifyRequest(recordings=[path for path, _ in files])
    names = _by_path(files)
    asked = StudyAsked("identification", wanted.runs, wanted.recordings, "", me.name, names=names)
    found = service.studies.add(asked, request, _IDENTIFIED_WITHIN_S)
    return _logged(service, me, found)


@router.post("/diagnoses", name="diagnose", status_code=201)
async def diagnose(
    wanted: Annotated[DiagnosisWanted, Body()], service: TheService, me: Engineer
) -> StudyData:
    """Diagnose why runs and a model differ, as `hil diagnose`; takes minutes."""
    model = service.models.path(wanted.model)
    if model is None:
        raise missing("model", wanted.model)
    files = await _files(service, wanted.runs, wanted.recordings)
    holdout = await _files(service, wanted.holdout, wanted.holdout_recordings)
    request = DiagnoseRequest(
        recordings=[path for path, _ in files],
        model=model.resolve(),
        holdout=[path for path, _ in holdout],
        at_most=wanted.at_most_min,
    )
    within_s = 60.0 * wanted.at_most_min + _WRITTEN_WITHIN_S
    runs = [*wanted.runs, *wanted.holdout]
    recordings = [*wanted.recordings, *wanted.holdout_recordings]
    names = {**_by_path([*files, *holdout]), str(model.resolve()): f"the model {wanted.model}"}
    asked = StudyAsked("diagnosis", runs, recordings, wanted.model, me.name, names=names)
    found = service.studies.add(asked, request, within_s)
    return _logged(service, me, found)


@router.get("/studies", name="list_studies")
async def list_studies(
    service: TheService, me: Viewer, kind: Annotated[StudyKind | None, Query()] = None
) -> list[StudyData]:
    """Identifications and diagnoses of all services, newest first."""
    del me
    return service.studies.of_kind(kind)


@router.get("/studies/{study}", name="get_study")
async def get_study(study: RunId, service: TheService, me: Viewer) -> StudyData:
    """A study."""
    del me
    return _there(service, study)


@router.post("/studies/{study}/cancel", name="cancel_study")
async def cancel_study(study: RunId, service: TheService, me: Engineer) -> StudyData:
    """End a study; a diagnosis writes its result so far."""
    refuse_elsewhere("study", _there(service, study))
    if not await service.studies.cancel(study):
        raise RefusedError(409, f"study {study} is finished")
    service.log.add(me.name, me.role, "study cancelled", str(study))
    return _there(service, study)


@router.delete("/studies/{study}", name="remove_study", status_code=204)
async def remove_study(study: RunId, service: TheService, me: Engineer) -> None:
    """Remove a finished study with its files; runs and saved models stay."""
    found = refuse_elsewhere("study", _there(service, study))
    if not service.studies.remove(study):
        raise RefusedError(409, f"study {study} is {found.state}", fix="cancel it first")
    service.log.add(me.name, me.role, "study removed", str(study), f"runs {found.runs} {found.model}")


@router.get("/studies/{study}/files/{name}", name="get_study_file", response_class=Response)
async def get_study_file(study: RunId, name: str, service: TheService, me: Viewer) -> FileResponse:
    """A file of a finished study: report, model, plan of a separating test."""
    del me
    if name not in _there(service, study).files:
        raise missing("file", name)
    path = await service.studies.file(study, name)
    media = "text/plain" if path.suffix in (".toml", ".csv", ".yaml") else None
    return left_file(path, f"study-{study}-{name}", media)


@router.get("/identifications/{study}", name="get_identification")
async def get_identification(study: RunId, service: TheService, me: Viewer) -> IdentificationData:
    """Result of an identification: responses with coherence, fit, parameters with intervals."""
    del me
    of = _with(service, study, "identification", "identification.json")
    folder = await service.studies.files(study)
    found = await service.worker_pool.ask("fitted", folder=str(folder.resolve()))
    return IdentificationData(study=of, **found)


@router.get("/diagnoses/{study}", name="get_diagnosis")
async def get_diagnosis(study: RunId, service: TheService, me: Viewer) -> DiagnosisData:
    """Result of a diagnosis: effects, alternatives with the tests that distinguish them, the map."""
    del me
    of = _with(service, study, "diagnosis", "diagnosis.json")
    content = json.loads(read_text(await service.studies.file(study, "diagnosis.json")))
    return DiagnosisData(study=of, **_findings(content))


def _findings(content: dict[str, Any]) -> dict[str, Any]:
    same = ("verdict", "gap", "holdout_gap", "map", "remaining_gap", "parameter_updates", "notes")
    effects = [
        {
            **{name: one[name] for name in ("id", "parameters", "standard_error", "confidence")},
            **{name: one["where"][name] for name in ("channels", "band_hz", "condition")},
            "one_of": one.get("class", ""),
        }
        for one in content["effects"]
    ]
    alternatives = [
        {name: one.get(name) for name in ("id", "confidence", "separating_test", "plan")}
        | {"one_of": one.get("class", "")}
        for one in content["alternatives"]
    ]
    facts = {"effects": effects, "alternatives": alternatives, "unfinished": content.get("unfinished", "")}
    return {**{name: content[name] for name in same}, **facts}


async def _files(service: Service, runs: list[int], recordings: list[int]) -> list[tuple[Path, str]]:
    """Where recordings are, and what people call each."""
    found = []
    for number in runs:
        run = service.runs.get(number)
        if run is None:
            raise missing("run", number)
        if run.state not in OVER or RECORDING not in service.with_progress(run).files:
            raise RefusedError(409, f"run {number} has no recording", fix="choose runs that have a recording")
        path = await service.file_of(number, RECORDING)
        found.append((path.resolve(), f"the recording of run {number}"))
    for number in recordings:
        given = service.recordings.get(number)
        if given is None:
            raise missing("recording", number)
        if given.state != "ready":
            raise RefusedError(
                409, f"recording {number} is {given.state}", fix="choose recordings that are ready"
            )
        path = await service.recordings.file(given)
        found.append((path.resolve(), f"the recording {number} ({given.name})"))
    return found


def _by_path(files: list[tuple[Path, str]]) -> dict[str, str]:
    return {str(path): name for path, name in files}


def _logged(service: Service, me: Me, study: StudyData) -> StudyData:
    of = f"runs {study.runs} recordings {study.recordings} {study.model}"
    service.log.add(me.name, me.role, study.kind, f"study {study.id}", of)
    return study


def _there(service: Service, study: int) -> StudyData:
    found = service.studies.get(study)
    if found is None:
        raise missing("study", study)
    return found


def _with(service: Service, study: int, kind: StudyKind, file: str) -> StudyData:
    found = _there(service, study)
    if found.kind != kind:
        raise missing(kind, study)
    if file not in found.files and found.place and found.state in STUDY_OVER:
        raise RefusedError(409, f"files of {kind} {study} are not in a store", fix=f"ask {found.place}")
    if file not in found.files:
        raise RefusedError(409, f"{kind} {study} has no result: {found.reason or found.state}")
    return found
