"""Whether the service works, and what it counts."""

from __future__ import annotations

import importlib.metadata
import time

from fastapi import APIRouter, Request, Response

from hil.api_schemas.api import Health
from hil.service.api._access import TheService, Viewer
from hil.service.api._guard import StopAddress
from hil.service.service import Service

router = APIRouter(tags=["service"])


@router.get("/health", name="health")
async def health(service: TheService, request: Request) -> Health:
    """State of the service and its store, and the address of its stop post; needs no token."""
    stop: StopAddress = request.app.state.stop_address
    up = service.stops.post is not None and service.stops.post.up
    service.tokens.any()
    keeper = service.keeper
    version = importlib.metadata.version("eaxle-hil")
    return Health(
        status="ok",
        version=version,
        up_s=round(time.monotonic() - service.began_s, 1),
        runs_not_stored=keeper.waiting() if keeper else 0,
        results_not_stored=_results_not_stored(service),
        store_problem=(keeper.rounds.problem or service.sharing.problem) if keeper else "",
        kept_apart=len(service.kept_apart),
        audit_problem=service.audit_problem,
        sign_in=service.sign_in.settings.name if service.sign_in is not None else "",
        stop_url=stop.seen_from(request.headers.get("host", "")) if up else "",
    )


@router.get("/metrics", name="metrics", response_class=Response)
async def metrics(service: TheService, me: Viewer) -> Response:
    """Metrics for Prometheus."""
    del me
    lines = ["# HELP hil_runs Runs by bench and state.", "# TYPE hil_runs gauge"]
    for (bench, state), count in sorted(service.runs.counts().items()):
        lines.append(f'hil_runs{{bench="{bench}",state="{state}"}} {count}')
    lines += ["# HELP hil_bench_state 1 for the state that a bench is in.", "# TYPE hil_bench_state gauge"]
    for name in service.benches:
        lines.append(f'hil_bench_state{{bench="{name}",state="{service.state(name)[0]}"}} 1')
    lines += ["# HELP hil_viewers Pages and programs that watch a bench.", "# TYPE hil_viewers gauge"]
    lines += [
        f'hil_viewers{{bench="{name}"}} {len(service.live_hub.viewers[name])}' for name in service.benches
    ]
    lines += ["# HELP hil_agents_connected Connected agents.", "# TYPE hil_agents_connected gauge"]
    lines.append(f"hil_agents_connected {sum(one.connected for one in service.agents.all())}")
    if service.keeper is not None:
        lines += ["# HELP hil_runs_not_stored Runs with files that are not in the store."]
        lines += ["# TYPE hil_runs_not_stored gauge", f"hil_runs_not_stored {service.keeper.waiting()}"]
        count = _results_not_stored(service)
        lines += ["# HELP hil_results_not_stored Studies, campaigns, recordings with files not in the store."]
        lines += ["# TYPE hil_results_not_stored gauge", f"hil_results_not_stored {count}"]
    lines += ["# HELP hil_up_seconds Seconds since the service started.", "# TYPE hil_up_seconds counter"]
    lines.append(f"hil_up_seconds {time.monotonic() - service.began_s:.1f}")
    return Response("\n".join(lines) + "\n", media_type="text/plain; version=0.0.4")


def _results_not_stored(service: Service) -> int:
    return service.studies.not_stored + service.campaigns.not_stored + service.recordings.not_stored
