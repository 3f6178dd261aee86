"""Recordings that people give: sent in pieces, then there for identifications and diagnoses."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Query, Request
from fastapi.responses import FileResponse
from starlette.responses import Response

from hil.api_schemas.agent import MOST_FILE_BYTES, FileThere, Sha256
from hil.api_schemas.api import Me, RunId
from hil.api_schemas.comparison import ChannelName
from hil.api_schemas.design import FileName
from hil.api_schemas.recording import (
    RecordingColumns,
    RecordingCurves,
    RecordingData,
    RecordingWanted,
    RecordingWhole,
)
from hil.api_schemas.study import STUDY_OVER
from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._given_files import PIECE
from hil.service.api._left_files import left_file
from hil.service.api._problems import RefusedError, missing, refuse_elsewhere
from hil.service.service import Service

router = APIRouter(prefix="/recordings", tags=["recordings"])
_Seconds = Annotated[float | None, Query(ge=-1e6, le=1e9, allow_inf_nan=False)]
_Buckets = Annotated[int, Query(ge=10, le=4000)]


@router.get("", name="list_recordings")
async def list_recordings(service: TheService, me: Viewer) -> list[RecordingData]:
    """Uploaded recordings of all services, newest first."""
    del me
    return service.recordings.all()


@router.post("", name="begin_recording", status_code=201)
async def begin_recording(
    wanted: Annotated[RecordingWanted, Body()], service: TheService, me: Engineer
) -> RecordingData:
    """Announce a recording; its pieces follow."""
    return service.recordings.begin(wanted, me.name)


@router.get("/{recording}", name="get_recording")
async def get_recording(recording: RunId, service: TheService, me: Viewer) -> RecordingData:
    """A recording: how much of it is here, or its channels."""
    del me
    return _there(service, recording)


@router.put("/{recording}/content", name="send_recording", openapi_extra=PIECE)
async def send_recording(
    recording: RunId,
    request: Request,
    service: TheService,
    me: Engineer,
    sha256: Annotated[Sha256, Query()],
    at: Annotated[int, Query(ge=0, le=MOST_FILE_BYTES)] = 0,
) -> FileThere:
    """Append a piece of at most 1 MB, if it starts at the file's present end; returns the size."""
    found = _arriving(service, recording, me)
    return FileThere(size=service.recordings.add(found, at, await request.body(), sha256))


@router.post("/{recording}/ending", name="end_recording")
async def end_recording(
    recording: RunId, whole: Annotated[RecordingWhole, Body()], service: TheService, me: Engineer
) -> RecordingData:
    """Have a complete upload compared with its SHA-256 and read."""
    found = _there(service, recording)
    if found.sha256 == whole.sha256 and found.state in ("checking", "ready"):
        return found  # the answer to the first time went astray
    found = _arriving(service, recording, me)
    if found.received != found.size:
        what = f"{found.received} of {found.size} bytes are here"
        raise RefusedError(409, what, where=found.name, fix="send the rest first")
    service.log.add(me.name, me.role, "recording given", f"recording {recording}", found.name)
    return service.recordings.check(found, sha256=whole.sha256)


@router.post("/{recording}/check", name="check_recording")
async def check_recording(
    recording: RunId, wanted: Annotated[RecordingColumns, Body()], service: TheService, me: Engineer
) -> RecordingData:
    """Read an uploaded recording anew with other columns as its channels."""
    found = refuse_elsewhere("recording", _there(service, recording))
    if found.state not in ("ready", "refused") or not service.recordings.is_here(found):
        raise RefusedError(409, f"recording {recording} is {found.state}", fix="give it anew")
    _refuse_used(service, recording)
    service.log.add(me.name, me.role, "recording read anew", f"recording {recording}", found.name)
    return service.recordings.check(found, columns=wanted.columns)


@router.delete("/{recording}", name="remove_recording", status_code=204)
async def remove_recording(recording: RunId, service: TheService, me: Engineer) -> None:
    """Remove an uploaded recording, or what has arrived of one; studies of it stay."""
    found = refuse_elsewhere("recording", _there(service, recording))
    _refuse_used(service, recording)
    if not service.recordings.remove(recording):
        raise RefusedError(409, f"recording {recording} is being read", fix="wait for that")
    service.log.add(me.name, me.role, "recording removed", f"recording {recording}", found.name)


@router.get("/{recording}/files/{name}", name="get_recording_file", response_class=Response)
async def get_recording_file(recording: RunId, name: str, service: TheService, me: Viewer) -> FileResponse:
    """An uploaded recording as it was given, or with its channels' names."""
    del me
    found = _there(service, recording)
    if name not in found.files:
        raise missing("file", name)
    path = await service.recordings.file(found, name)
    return left_file(path, name, "application/octet-stream")


@router.get("/{recording}/curves", name="get_recording_curves")
async def get_recording_curves(
    recording: RunId,
    service: TheService,
    me: Viewer,
    channel: Annotated[list[ChannelName], Query(min_length=1, max_length=12)],
    start_s: _Seconds = None,
    end_s: _Seconds = None,
    most: _Buckets = 600,
) -> RecordingCurves:
    """Channels of an uploaded recording as lowest and highest value in each of `most` buckets."""
    del me
    path = await _ready(service, recording)
    found = await service.viewing.ask(
        "recording_measured", path=path, channels=channel, start_s=start_s, end_s=end_s, most=most
    )
    return RecordingCurves(**found)


@router.get("/{recording}/simulation", name="simulate_recording")
async def simulate_recording(
    recording: RunId,
    service: TheService,
    me: Engineer,
    model: Annotated[FileName, Query()],
    start_s: _Seconds = None,
    end_s: _Seconds = None,
    most: _Buckets = 600,
) -> RecordingCurves:
    """Outputs of a model driven by an uploaded recording's torque, as `hil simulate`, with their gaps."""
    del me
    chosen = service.models.path(model)
    if chosen is None:
        raise missing("model", model)
    path = await _ready(service, recording)
    found = await service.viewing.ask(
        "recording_simulated",
        path=path,
        model=str(chosen.resolve()),
        start_s=start_s,
        end_s=end_s,
        most=most,
    )
    return RecordingCurves(**found)


async def _ready(service: Service, recording: int) -> str:
    """Where the file of one is that can be read."""
    found = _there(service, recording)
    if found.state != "ready":
        raise RefusedError(409, f"recording {recording} is {found.state}", fix="choose one that is ready")
    return str((await service.recordings.file(found)).resolve())


def _there(service: Service, recording: int) -> RecordingData:
    found = service.recordings.get(recording)
    if found is None:
        raise missing("recording", recording)
    return found


def _arriving(service: Service, recording: int, me: Me) -> RecordingData:
    found = refuse_elsewhere("recording", _there(service, recording))
    if found.given_by != me.name:
        raise RefusedError(403, f"recording {recording} is given by {found.given_by}")
    if found.state != "arriving":
        raise RefusedError(409, f"recording {recording} is {found.state}", fix="give it anew")
    return found


def _refuse_used(service: Service, recording: int) -> None:
    for study in service.studies.own():
        if recording in study.recordings and study.state not in STUDY_OVER:
            what = f"recording {recording} is used by the {study.kind} {study.id}"
            raise RefusedError(409, what, fix="wait for its end, or cancel it")
