"""Bench files that people write, and checks of files in TOML as they are written."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Request, Response

from hil.api_schemas.design import FileName
from hil.api_schemas.file_check import BenchFileData, FileCheck, FileCheckWanted
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._given_files import GIVEN, body_of, described, file_text, readable
from hil.service.api._holds import refuse_held
from hil.service.api._problems import RefusedError, missing
from hil.service.api._versions import BasedOn
from hil.service.files.catalogues import bench_file_data
from hil.service.files.plan_checks import mistakes_of
from hil.service.service import Service

router = APIRouter(tags=["bench files"])


@router.get("/bench-files", name="list_bench_files")
async def list_bench_files(service: TheService, me: Viewer) -> list[BenchFileData]:
    """All bench files, built-in and uploaded."""
    del me
    found = readable(service.bench_files, bench_file_data)
    return [_with_served(service, one) for one in found]


@router.get("/bench-files/{bench}/text", name="get_bench_file_text", response_class=Response)
async def get_bench_file_text(bench: FileName, service: TheService, me: Viewer) -> Response:
    """A bench file."""
    del me
    return file_text(service.bench_files, "bench file", bench)


@router.put("/bench-files/{bench}", name="give_bench_file", openapi_extra=GIVEN)
async def give_bench_file(
    bench: FileName, request: Request, service: TheService, me: Engineer, based_on: BasedOn = ""
) -> BenchFileData:
    """Upload a bench file (TOML); the content of a name cannot be changed."""
    text = await body_of(request, bench)
    await service.upload_reader.check_file("bench", bench, text, service.models.paths())
    service.bench_files.give(bench, text, me.name, based_on)
    service.log.add(me.name, me.role, "bench file given", bench)
    return described(service.bench_files, bench_file_data, "bench file", bench)


@router.delete("/bench-files/{bench}", name="remove_bench_file", status_code=204)
async def remove_bench_file(bench: FileName, service: TheService, me: Engineer) -> None:
    """Remove an uploaded bench file."""
    if service.served_benches.has(bench):
        raise RefusedError(409, "is a bench of this service", where=bench, fix="take it out of service first")
    if not service.bench_files.remove(bench):
        raise missing("given bench file", bench)
    service.log.add(me.name, me.role, "bench file removed", bench)


@router.put("/bench-files/{bench}/service", name="serve_bench_file")
async def serve_bench_file(bench: FileName, service: TheService, me: Engineer) -> BenchFileData:
    """Make a simulated bench of an uploaded bench file, with a queue of its own."""
    found = described(service.bench_files, bench_file_data, "bench file", bench)
    path = service.bench_files.path(bench)
    if found.built_in or path is None:
        raise missing("given bench file", bench)
    if not service.served_benches.has(bench):
        service.serve_bench(bench, read_text(path))
        service.log.add(me.name, me.role, "bench put into service", bench)
    return _with_served(service, found)


@router.delete("/bench-files/{bench}/service", name="end_bench_file_service")
async def end_bench_file_service(bench: FileName, service: TheService, me: Engineer) -> BenchFileData:
    """Take the bench of an uploaded bench file out of service; its runs stay."""
    found = described(service.bench_files, bench_file_data, "bench file", bench)
    if not service.served_benches.has(bench) or service.own(bench) is None:
        raise missing("bench of a bench file", bench)
    refuse_held(service, bench)
    if not service.drop_bench(bench):  # a run has begun just now
        raise RefusedError(409, "a run is under way there", where=bench, fix="await it, or abort it")
    service.log.add(me.name, me.role, "bench taken out of service", bench)
    return _with_served(service, found)


def _with_served(service: Service, found: BenchFileData) -> BenchFileData:
    served = not found.built_in and service.served_benches.has(found.name)
    return found.model_copy(update={"served": served})


@router.post("/file-checks", name="check_file")
async def check_file(
    wanted: Annotated[FileCheckWanted, Body()], service: TheService, me: Engineer
) -> FileCheck:
    """Mistakes of a model, controller or bench file by line, and what follows from it; keeps nothing."""
    del me
    models = service.models.paths()
    if wanted.model is not None and wanted.model not in models:
        raise missing("model", wanted.model)
    try:
        found = await service.upload_reader.check_file(
            wanted.kind, wanted.name, wanted.text, models, wanted.model or ""
        )
        return FileCheck(mistakes=[], **found)
    except BadInputError as error:
        return FileCheck(mistakes=mistakes_of(error))
