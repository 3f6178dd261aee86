"""Versions of what people gave: who gave which text when, also of what was replaced or removed."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response

from hil.api_schemas.api import PlanName
from hil.api_schemas.file_check import VersionData
from hil.api_schemas.upload import VersionedKind
from hil.service.api._access import TheService, Viewer
from hil.service.api._problems import missing

router = APIRouter(prefix="/versions", tags=["plans"])
#: Name of the file that a given one was made from: both are versions of one family.
BasedOn = Annotated[str, Query(pattern=r"^([A-Za-z0-9][A-Za-z0-9_.-]{0,63})?$")]

#: SHA-256 of the text that a new one replaces, as its ETag; empty if the name has to be free.
InsteadOf = Annotated[str | None, Query(pattern=r"^([0-9a-f]{64})?$")]


@router.get("/{kind}/{name}", name="list_versions")
async def list_versions(
    kind: VersionedKind, name: PlanName, service: TheService, me: Viewer
) -> list[VersionData]:
    """Versions of an uploaded plan, model, controller or bench file, newest first."""
    del me
    return [VersionData(**asdict(one)) for one in service.versions.of(kind, name)]


@router.get("/{kind}/{name}/{number}/text", name="get_version_text", response_class=Response)
async def get_version_text(
    kind: VersionedKind,
    name: PlanName,
    number: Annotated[int, Path(ge=1, le=2**31 - 1)],
    service: TheService,
    me: Viewer,
) -> Response:
    """The text of a version."""
    del me
    text = service.versions.text(kind, name, number)
    if text is None:
        raise missing("version", number)
    return Response(text, media_type="text/plain")
