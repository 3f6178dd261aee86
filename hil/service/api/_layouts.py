"""Plots that somebody has chosen for runs of a plan: wherever they sign in, they are there."""

from __future__ import annotations

from fastapi import APIRouter

from hil.api_schemas.api import PlanName
from hil.api_schemas.view import LayoutData
from hil.service.api._access import TheService, Viewer

router = APIRouter(prefix="/layouts", tags=["people"])


@router.get("/{plan}", name="get_layout")
async def get_layout(plan: PlanName, service: TheService, me: Viewer) -> LayoutData:
    """The caller's plots for runs of a plan."""
    return LayoutData(text=service.layouts.of(me.name, plan))


@router.put("/{plan}", name="keep_layout")
async def keep_layout(plan: PlanName, layout: LayoutData, service: TheService, me: Viewer) -> LayoutData:
    """Keep the caller's plots for runs of a plan; the oldest of 200 give way."""
    if layout.text:
        service.layouts.keep(me.name, plan, layout.text)
    else:
        service.layouts.forget(me.name, plan)
    return layout
