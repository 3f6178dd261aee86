"""Plans, and what is known of a run of them beforehand."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Body, Request, Response

from hil.api_schemas.api import LADDER, ForecastData, ForecastWanted, PlanData, PlanName
from hil.api_schemas.plan_check import PlanCheck, PlanCheckWanted
from hil.api_schemas.upload import KeptApart
from hil.core.errors import BadInputError
from hil.service.api._access import Engineer, Operator, TheService, Viewer
from hil.service.api._benches import known
from hil.service.api._problems import RefusedError, missing
from hil.service.api._versions import BasedOn, InsteadOf
from hil.service.files.plan_checks import mistakes_of

router = APIRouter(tags=["plans"])
_YAML = "application/yaml"


@router.get("/plans", name="list_plans")
async def list_plans(service: TheService, me: Viewer) -> list[PlanData]:
    """All plans."""
    del me
    return service.plans.all()


@router.get("/plans/{plan}", name="get_plan")
async def get_plan(plan: PlanName, service: TheService, me: Viewer) -> PlanData:
    """A plan and its variables."""
    del me
    found = service.plans.get(plan)
    if found is None:
        raise missing("plan", plan)
    return found


@router.get("/plans/{plan}/text", name="get_plan_text", response_class=Response)
async def get_plan_text(plan: PlanName, service: TheService, me: Viewer) -> Response:
    """A plan's YAML; the ETag of an uploaded one is what `instead_of` takes."""
    del me
    sha256 = service.plans.sha256(plan)  # before the text: what replaces it meanwhile has another
    text = service.plans.text(plan)
    if text is None:
        raise missing("plan", plan)
    return Response(text, media_type=_YAML, headers={"etag": f'"{sha256}"'} if sha256 else None)


@router.put(
    "/plans/{plan}",
    name="give_plan",
    openapi_extra={"requestBody": {"required": True, "content": {_YAML: {"schema": {"type": "string"}}}}},
)
async def give_plan(
    plan: PlanName,
    request: Request,
    service: TheService,
    me: Engineer,
    based_on: BasedOn = "",
    instead_of: InsteadOf = None,
) -> PlanData:
    """Upload a plan (YAML), or replace an uploaded one: only the text `instead_of`, if that is given."""
    try:
        text = (await request.body()).decode("utf-8")
    except UnicodeDecodeError as error:
        raise RefusedError(422, "is not UTF-8", where=plan) from error
    found = await service.upload_reader.plan(plan, text, me.name, based_on, instead_of)
    service.log.add(me.name, me.role, "plan given", plan)
    return found


@router.delete("/plans/{plan}", name="remove_plan", status_code=204)
async def remove_plan(plan: PlanName, service: TheService, me: Engineer) -> None:
    """Remove an uploaded plan; its runs stay."""
    if not service.plans.remove(plan):
        raise missing("given plan", plan)
    service.log.add(me.name, me.role, "plan removed", plan)


@router.get("/kept-apart", name="list_kept_apart")
async def list_kept_apart(service: TheService, me: Viewer) -> list[KeptApart]:
    """Plans, controllers and models of an earlier version's folder with other content in the database."""
    del me
    return service.kept_apart


@router.post("/plan-checks", name="check_plan")
async def check_plan(
    wanted: Annotated[PlanCheckWanted, Body()], service: TheService, me: Engineer
) -> PlanCheck:
    """Mistakes of a plan by line, as it is written; keeps nothing."""
    del me
    try:
        return PlanCheck(mistakes=[], plan=await service.upload_reader.check(wanted.name, wanted.text))
    except BadInputError as error:
        return PlanCheck(mistakes=mistakes_of(error))


@router.post("/forecasts", name="forecast")
async def forecast(
    wanted: Annotated[ForecastWanted, Body()], service: TheService, me: Operator
) -> ForecastData:
    """Predicted duration, peaks and criteria; takes seconds, moves nothing."""
    bench = known(service, wanted.bench)
    if wanted.text is not None:
        if LADDER.index(me.role) < LADDER.index("engineer"):
            raise RefusedError(403, f"{me.name} is {me.role}; engineer is needed", where="text")
        written = await service.upload_reader.chosen(wanted.plan, wanted.text, wanted.values)
        return await service.forecast(written, bench)
    plan = service.plans.chosen(wanted.plan, wanted.values)
    if plan is None:
        raise missing("plan", wanted.plan)
    return await service.forecast(plan, bench)


@router.get("/schemas/{kind}", name="get_schema")
async def get_schema(
    kind: Literal["plan", "bench", "model", "controller", "campaign"], service: TheService, me: Viewer
) -> dict[str, Any]:
    """JSON schema of a file that people write, as `hil schema`."""
    del me
    return await service.worker_pool.ask("schema", kind=kind)
