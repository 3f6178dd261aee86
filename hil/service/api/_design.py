"""Models and controllers, and the drafts that become controllers."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, Request, Response

from hil.api_schemas.api import PlanData, PlanName
from hil.api_schemas.design import (
    CloudData,
    CloudWanted,
    ControllerData,
    DesignData,
    DraftData,
    DraftWanted,
    FileName,
    ModelData,
    PlanCopyWanted,
    SegmentsData,
    SegmentsWanted,
)
from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._given_files import GIVEN, body_of, described, file_text, readable
from hil.service.api._problems import RefusedError, missing
from hil.service.api._versions import BasedOn
from hil.service.files.catalogues import controller_data, model_data
from hil.service.service import Service

router = APIRouter(tags=["design"])


@router.get("/models", name="list_models")
async def list_models(service: TheService, me: Viewer) -> list[ModelData]:
    """All models, built-in and uploaded."""
    del me
    return list(readable(service.models, model_data))


@router.get("/models/{model}/text", name="get_model_text", response_class=Response)
async def get_model_text(model: FileName, service: TheService, me: Viewer) -> Response:
    """A model's file."""
    del me
    return file_text(service.models, "model", model)


@router.put("/models/{model}", name="give_model", openapi_extra=GIVEN)
async def give_model(
    model: FileName, request: Request, service: TheService, me: Engineer, based_on: BasedOn = ""
) -> ModelData:
    """Upload a model file (TOML); the content of a name cannot be changed."""
    text = await body_of(request, model)
    await service.upload_reader.read("model", model, text)
    service.models.give(model, text, me.name, based_on)
    service.log.add(me.name, me.role, "model given", model)
    return described(service.models, model_data, "model", model)


@router.delete("/models/{model}", name="remove_model", status_code=204)
async def remove_model(model: FileName, service: TheService, me: Engineer) -> None:
    """Remove an uploaded model."""
    if not service.models.remove(model):
        raise missing("given model", model)
    service.log.add(me.name, me.role, "model removed", model)


@router.get("/controllers", name="list_controllers")
async def list_controllers(service: TheService, me: Viewer) -> list[ControllerData]:
    """All controllers, built-in and uploaded."""
    del me
    return list(readable(service.controllers, controller_data))


@router.get("/controllers/{controller}/text", name="get_controller_text", response_class=Response)
async def get_controller_text(controller: FileName, service: TheService, me: Viewer) -> Response:
    """A controller's file."""
    del me
    return file_text(service.controllers, "controller", controller)


@router.put("/controllers/{controller}", name="give_controller", openapi_extra=GIVEN)
async def give_controller(
    controller: FileName, request: Request, service: TheService, me: Engineer, based_on: BasedOn = ""
) -> ControllerData:
    """Upload a controller file (TOML); uploaded plans can load it by name."""
    text = await body_of(request, controller)
    await service.upload_reader.read("controller", controller, text)
    service.controllers.give(controller, text, me.name, based_on)
    service.log.add(me.name, me.role, "controller given", controller)
    return described(service.controllers, controller_data, "controller", controller)


@router.delete("/controllers/{controller}", name="remove_controller", status_code=204)
async def remove_controller(controller: FileName, service: TheService, me: Engineer) -> None:
    """Remove an uploaded controller, if no plan loads it."""
    using = service.plans.loading(f"{controller}.toml")
    if using:
        raise RefusedError(
            409, f"is loaded by the plan '{using[0]}'", where=controller, fix="remove that plan first"
        )
    if not service.controllers.remove(controller):
        raise missing("given controller", controller)
    service.log.add(me.name, me.role, "controller removed", controller)


@router.post("/plans/{plan}/copies", name="copy_plan", status_code=201)
async def copy_plan(
    plan: PlanName, wanted: Annotated[PlanCopyWanted, Body()], service: TheService, me: Engineer
) -> PlanData:
    """Copy a plan and replace its controllers."""
    for name in wanted.controllers.values():
        if service.controllers.path(name) is None:
            raise missing("controller", name)
    files = {old: f"{name}.toml" for old, name in wanted.controllers.items()}
    found = service.plans.copied(plan, wanted.name, files, me.name)
    if found is None:
        raise missing("plan", plan)
    service.log.add(me.name, me.role, "plan given", wanted.name, f"copy of {plan}")
    return found


@router.post("/drafts", name="draft", response_model=DraftData)
async def draft(wanted: Annotated[DraftWanted, Body()], service: TheService, me: Engineer) -> Response:
    """Loops, margins and steps of a controller on a model."""
    del me
    # As the worker wrote it: who moves a slider waits for it.
    found = await service.drawing.ask_text("draft", **_chosen(service, wanted))
    return Response(found, media_type="application/json")


@router.post("/drafts/clouds", name="draft_cloud", response_model=CloudData)
async def draft_cloud(wanted: Annotated[CloudWanted, Body()], service: TheService, me: Engineer) -> Response:
    """A draft on cars drawn around its model: loops, margins, overshoot and band energy; about a second."""
    del me
    found = await service.clouds.ask_text("cloud", **_chosen(service, wanted))
    return Response(found, media_type="application/json")


@router.post("/drafts/segments", name="draft_segments")
async def draft_segments(
    wanted: Annotated[SegmentsWanted, Body()], service: TheService, me: Engineer
) -> SegmentsData:
    """Margins in every segment of a plan, of its own controllers and of a draft in their place."""
    del me
    if service.plans.get(wanted.plan) is None:
        raise missing("plan", wanted.plan)
    chosen = {**_chosen(service, wanted), "plan": str(service.plans.source(wanted.plan).resolve())}
    return SegmentsData(**await service.clouds.ask("segments", **chosen))


@router.post("/designs", name="design")
async def design(wanted: Annotated[DraftWanted, Body()], service: TheService, me: Engineer) -> DesignData:
    """Complete design, as `hil design`: the controller's file and the worst case of all plants."""
    del me
    return DesignData(**await service.drawing.ask("design", **_chosen(service, wanted)))


def _chosen(service: Service, wanted: DraftWanted) -> dict[str, Any]:
    path = service.models.path(wanted.model)
    if path is None:
        raise missing("model", wanted.model)
    return {**wanted.model_dump(), "model": str(path.resolve())}
