"""Views of a run: all but its samples, traces of any stretch, a spectrum, samples for XY."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from hil.api_schemas.api import RunId
from hil.api_schemas.comparison import ChannelName
from hil.api_schemas.view import Channels, RunSamples, RunSpectrum, RunTraces, RunViewData
from hil.service.api._access import TheService, Viewer
from hil.service.api._runs import there
from hil.service.live.run_views import RunViews

router = APIRouter(prefix="/runs", tags=["runs"])
_Seconds = Annotated[float, Query(ge=-1e6, le=1e9, allow_inf_nan=False)]
_CLOSE_S = 0.02  # a bucket: closer than this, samples are read


@router.get("/{run}/view", name="get_run_view")
async def get_run_view(run: RunId, service: TheService, me: Viewer) -> RunViewData:
    """Channels, segments, events, limits, criteria and evidence of a run, active or finished."""
    del me
    found = await RunViews(service).view(there(service, run))
    return RunViewData(run=run, **found)


@router.get("/{run}/traces", name="get_run_traces")
async def get_run_traces(
    run: RunId,
    service: TheService,
    me: Viewer,
    channel: Annotated[Channels, Query()],
    start_s: _Seconds = -1e6,
    end_s: _Seconds = 1e9,
    most: Annotated[int, Query(ge=10, le=4000)] = 1000,
) -> RunTraces:
    """Channels of a stretch, as lowest and highest value in each of `most` buckets; no peak is lost."""
    del me
    close = end_s - start_s < _CLOSE_S * most
    asked = {"channels": channel, "start_s": start_s, "end_s": end_s, "most": most}
    return RunTraces(run=run, **await RunViews(service).traces(there(service, run), close=close, **asked))


@router.get("/{run}/spectrum", name="get_run_spectrum")
async def get_run_spectrum(
    run: RunId,
    service: TheService,
    me: Viewer,
    channel: Annotated[ChannelName, Query()],
    start_s: _Seconds = -1e6,
    end_s: _Seconds = 1e9,
) -> RunSpectrum:
    """Power spectral density of a channel over a stretch of at most a million samples."""
    del me
    asked = {"channel": channel, "start_s": start_s, "end_s": end_s}
    return RunSpectrum(run=run, **await RunViews(service).ask("run_spectrum", there(service, run), **asked))


@router.get("/{run}/samples", name="get_run_samples")
async def get_run_samples(
    run: RunId,
    service: TheService,
    me: Viewer,
    channel: Annotated[Channels, Query()],
    start_s: _Seconds = -1e6,
    end_s: _Seconds = 1e9,
    most: Annotated[int, Query(ge=10, le=20_000)] = 4000,
) -> RunSamples:
    """Samples of channels at the same moments, every n-th of a stretch of at most a million."""
    del me
    asked = {"channels": channel, "start_s": start_s, "end_s": end_s, "most": most}
    return RunSamples(run=run, **await RunViews(service).ask("run_samples", there(service, run), **asked))
