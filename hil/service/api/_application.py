"""Puts the parts of the API together."""

from __future__ import annotations

import importlib.metadata
import json

from fastapi import Depends, FastAPI
from starlette.types import ASGIApp

from hil.service.api import (
    _agents,
    _bench_files,
    _benches,
    _campaigns,
    _comparisons,
    _design,
    _handovers,
    _health,
    _layouts,
    _live,
    _notes,
    _page,
    _people,
    _pictures,
    _plans,
    _recordings,
    _reservations,
    _run_list,
    _run_views,
    _runs,
    _sign_in,
    _studies,
    _trends,
    _tunings,
    _versions,
)
from hil.service.api._guard import Guard, Guarding
from hil.service.api._problems import RESPONSES, answer_problems
from hil.service.api._queries import refuse_unknown_query
from hil.service.service import Service

PREFIX = "/api/v1"
_PARTS = (
    _health,
    _benches,
    _reservations,
    _handovers,
    _agents,
    _live,
    _plans,
    _pictures,
    _runs,
    _notes,
    _run_views,
    _run_list,
    _comparisons,
    _trends,
    _design,
    _bench_files,
    _versions,
    _recordings,
    _studies,
    _tunings,
    _campaigns,
    _layouts,
    _people,
    _sign_in,
)


def application(service: Service, guarding: Guarding) -> ASGIApp:
    """The whole of it, guarded."""
    app = _bare(service)
    app.state.stop_address = guarding.stop
    return Guard(app, guarding)


def openapi_text() -> str:
    """The OpenAPI document, as it is kept in docs/reference/openapi.json."""
    return json.dumps(_bare(None).openapi(), indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def _bare(service: Service | None) -> FastAPI:
    app = FastAPI(
        title="e-Axle HIL bench service",
        version=importlib.metadata.version("eaxle-hil"),
        docs_url=None,  # its page would be loaded from elsewhere
        redoc_url=None,
        openapi_url=f"{PREFIX}/openapi.json",
        separate_input_output_schemas=False,
        responses=RESPONSES,
        generate_unique_id_function=lambda route: route.name,
    )
    app.state.service = service
    for part in _PARTS:
        app.include_router(part.router, prefix=PREFIX, dependencies=[Depends(refuse_unknown_query)])
    _page.add_to(app)
    answer_problems(app)
    return app
