"""Notes of a shift for whoever has the bench next."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from hil.api_schemas.api import BenchName
from hil.api_schemas.team import HandoverData, HandoverWanted
from hil.core.errors.wording import shortened
from hil.service.api._access import Operator, TheService, Viewer
from hil.service.api._benches import known

router = APIRouter(prefix="/benches/{bench}/handovers", tags=["benches"])
_LAST = 2**31 - 1


@router.get("", name="list_handovers")
async def list_handovers(
    bench: BenchName,
    service: TheService,
    me: Viewer,
    before: Annotated[int, Query(ge=1, le=_LAST)] = _LAST,
    most: Annotated[int, Query(ge=1, le=200)] = 20,
) -> list[HandoverData]:
    """Hand-over notes of a bench, newest first."""
    del me
    return service.handovers.of(known(service, bench), before, most)


@router.post("", name="add_handover", status_code=201)
async def add_handover(
    bench: BenchName, wanted: HandoverWanted, service: TheService, me: Operator
) -> HandoverData:
    """Add a hand-over note; it stays as it is."""
    found = service.handovers.add(known(service, bench), me.name, wanted)
    service.log.add(
        me.name, me.role, "hand-over", bench, f"{wanted.day}, {wanted.shift}: {shortened(wanted.text, 200)}"
    )
    service.changed(bench)
    return found
