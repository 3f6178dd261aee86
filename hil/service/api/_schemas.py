"""JSON schemas, for editors and forms."""

from __future__ import annotations

from typing import Any, Literal

from fastapi import APIRouter

from hil.service.api._access import TheService, Viewer

router = APIRouter(tags=["plans"])


@router.get("/schemas/{kind}", name="get_schema")
async def get_schema(
    kind: Literal["plan", "bench", "model", "controller", "campaign"], service: TheService, me: Viewer
) -> dict[str, Any]:
    """JSON schema of a file that people write, as `hil schema`."""
    del me
    return await service.worker_pool.ask("schema", kind=kind)
