"""Pictures that plans show with their prompts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Request, Response
from fastapi import Path as InAddress

from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.files.pictures import MEDIA
from test_plans import PICTURE

router = APIRouter(tags=["plans"])
PictureName = Annotated[str, InAddress(pattern=f"^{PICTURE}$", max_length=64)]
_BINARY: dict[str, Any] = {"schema": {"type": "string", "format": "binary"}}
_CONTENT = dict.fromkeys(sorted(set(MEDIA.values())), _BINARY)
#: An SVG that is opened by itself runs and loads nothing.
_HEADERS = {"content-security-policy": "default-src 'none'; style-src 'unsafe-inline'; sandbox"}


@router.get("/pictures", name="list_pictures")
async def list_pictures(service: TheService, me: Viewer) -> list[str]:
    """Names of all pictures."""
    del me
    return service.pictures.names()


@router.get(
    "/pictures/{picture}", name="get_picture", response_class=Response, responses={200: {"content": _CONTENT}}
)
async def get_picture(picture: PictureName, service: TheService, me: Viewer) -> Response:
    """A picture."""
    del me
    content = service.pictures.content(picture)
    if content is None:
        raise missing("picture", picture)
    return Response(content, media_type=MEDIA[Path(picture).suffix], headers=_HEADERS)


@router.put(
    "/pictures/{picture}",
    name="give_picture",
    status_code=204,
    openapi_extra={"requestBody": {"required": True, "content": _CONTENT}},
)
async def give_picture(picture: PictureName, request: Request, service: TheService, me: Engineer) -> None:
    """Upload a picture (PNG, JPEG, SVG; 250 kB at most); the content of a name cannot be changed."""
    service.pictures.give(picture, await request.body(), me.name)
    service.log.add(me.name, me.role, "picture given", picture)


@router.delete("/pictures/{picture}", name="remove_picture", status_code=204)
async def remove_picture(picture: PictureName, service: TheService, me: Engineer) -> None:
    """Remove a picture, if no plan shows it."""
    using = service.plans.loading(picture)
    if using:
        raise RefusedError(
            409, f"is shown by the plan '{using[0]}'", where=picture, fix="remove that plan first"
        )
    if not service.pictures.remove(picture):
        raise missing("picture", picture)
    service.log.add(me.name, me.role, "picture removed", picture)
