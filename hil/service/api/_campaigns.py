"""Campaigns: many simulations of a plan."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Path
from fastapi.responses import FileResponse
from starlette.responses import Response

from hil.api_schemas.api import RunId
from hil.api_schemas.campaign import (
    SUMMARY,
    TABLE,
    CampaignData,
    CampaignExample,
    CampaignFindings,
    CampaignWanted,
    SimulationFiles,
)
from hil.service.api._access import Engineer, TheService, Viewer
from hil.service.api._left_files import left_file
from hil.service.api._problems import RefusedError, missing, refuse_elsewhere
from hil.service.service import Service

router = APIRouter(tags=["campaigns"])
_TABLES = "application/vnd.apache.parquet"


@router.post("/campaigns", name="add_campaign", status_code=201)
async def add_campaign(
    wanted: Annotated[CampaignWanted, Body()], service: TheService, me: Engineer
) -> CampaignData:
    """Queue a campaign, as `hil campaign`; it needs no bench."""
    found = await service.campaigns.add(wanted, service.places(), me.name)
    text = f"{found.name}: {found.simulations} simulations"
    service.log.add(me.name, me.role, "campaign", f"campaign {found.id}", text)
    return found


@router.get("/campaigns", name="list_campaigns")
async def list_campaigns(service: TheService, me: Viewer) -> list[CampaignData]:
    """Campaigns of all services with their progress and pass rates so far, newest first."""
    del me
    return service.campaigns.all()


@router.get("/campaign-examples", name="list_campaign_examples")
async def list_campaign_examples(service: TheService, me: Viewer) -> list[CampaignExample]:
    """The built-in campaigns, with their text."""
    del me
    return await service.campaigns.examples()


@router.get("/campaigns/{campaign}", name="get_campaign")
async def get_campaign(campaign: RunId, service: TheService, me: Viewer) -> CampaignData:
    """A campaign."""
    del me
    return _there(service, campaign)


@router.post("/campaigns/{campaign}/cancel", name="cancel_campaign")
async def cancel_campaign(campaign: RunId, service: TheService, me: Engineer) -> CampaignData:
    """End a campaign and keep active simulations, in a few seconds; a second request does not wait."""
    refuse_elsewhere("campaign", _there(service, campaign))
    if not await service.campaigns.cancel(campaign):
        raise RefusedError(409, f"campaign {campaign} is finished")
    service.log.add(me.name, me.role, "campaign cancelled", str(campaign))
    return _there(service, campaign)


@router.post("/campaigns/{campaign}/resume", name="resume_campaign")
async def resume_campaign(campaign: RunId, service: TheService, me: Engineer) -> CampaignData:
    """Resume a cancelled or failed campaign; simulate only what is missing."""
    found = refuse_elsewhere("campaign", _there(service, campaign))
    if not service.campaigns.resume(campaign):
        raise RefusedError(409, f"campaign {campaign} is {found.state}")
    service.log.add(me.name, me.role, "campaign resumed", str(campaign))
    return _there(service, campaign)


@router.delete("/campaigns/{campaign}", name="remove_campaign", status_code=204)
async def remove_campaign(campaign: RunId, service: TheService, me: Engineer) -> None:
    """Remove a finished campaign with its files."""
    found = refuse_elsewhere("campaign", _there(service, campaign))
    if not service.campaigns.remove(campaign):
        raise RefusedError(409, f"campaign {campaign} is {found.state}", fix="cancel it first")
    text = f"{found.name}: {found.done} of {found.simulations} simulations"
    service.log.add(me.name, me.role, "campaign removed", str(campaign), text)


@router.get("/campaigns/{campaign}/findings", name="get_campaign_findings")
async def get_campaign_findings(campaign: RunId, service: TheService, me: Viewer) -> CampaignFindings:
    """Distributions of a finished campaign, what its criteria depend on, worst cases."""
    del me
    found = _there(service, campaign)
    if not {SUMMARY, TABLE} <= set(found.files):
        raise RefusedError(409, f"campaign {campaign} has no result: {found.reason or found.state}")
    files = [await service.campaigns.file(campaign, name) for name in (SUMMARY, TABLE)]
    summary, table = (str(path.resolve()) for path in files)
    return CampaignFindings(
        **await service.worker_pool.ask("campaign_findings", summary=summary, table=table)
    )


@router.get("/campaigns/{campaign}/simulations/{simulation}", name="get_campaign_simulation")
async def get_campaign_simulation(
    campaign: RunId,
    simulation: Annotated[int, Path(ge=0, le=10_000_000)],
    service: TheService,
    me: Engineer,
) -> SimulationFiles:
    """A simulation as files: given back to the service, it is run on a simulated bench."""
    del me
    refuse_elsewhere("campaign", _there(service, campaign))
    folder = service.campaigns.given(campaign)
    name = f"campaign-{campaign}-car-{simulation}"
    found = await service.worker_pool.ask(
        "campaign_car", folder=str(folder.resolve()), simulation=simulation, name=name
    )
    return SimulationFiles(**found)


@router.get("/campaigns/{campaign}/files/{name}", name="get_campaign_file", response_class=Response)
async def get_campaign_file(campaign: RunId, name: str, service: TheService, me: Viewer) -> FileResponse:
    """A file of a finished campaign: report, `campaign.json`, the table as `simulations.parquet`."""
    del me
    if name not in _there(service, campaign).files:
        raise missing("file", name)
    path = await service.campaigns.file(campaign, name)
    return left_file(path, f"campaign-{campaign}-{name}", _TABLES)


def _there(service: Service, campaign: int) -> CampaignData:
    found = service.campaigns.get(campaign)
    if found is None:
        raise missing("campaign", campaign)
    return found
