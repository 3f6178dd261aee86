"""What is live, as server-sent events. A viewer that is slow is sent less at a time, never what is old."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator, Callable, Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse

from hil.api_schemas.api import BenchName
from hil.api_schemas.comparison import ChannelName
from hil.core.result import CriterionResult
from hil.service.api._access import Still, TheService, Viewer
from hil.service.api._benches import known
from hil.service.api._problems import RefusedError
from hil.service.live.live import BUCKET_S, MOST_BUCKETS, Spectrum, Stretch
from hil.service.live.live_hub import LiveView
from hil.service.service import Service
from hil.service.store import in_turns
from hil.service.worker_pool.drawn_numbers import numbers
from hil.service.worker_pool.run_view import marks_of

router = APIRouter(tags=["live"])
#: What a viewer is sent who does not say which.
CHANNELS = (
    "motor_speed_rad_s",
    "wheel_speed_rad_s",
    "shaft_torque_nm",
    "motor_torque_ref_nm",
    "motor_torque_nm",
    "vehicle_speed_m_s",
)
_MOST_VIEWERS = 200
_SHORTEST_S = 0.04  # 20 updates a second, which need not be even to a millisecond
_LONGEST_S = 2.0  # without anything to say; a viewer who may look no longer is noticed as soon
_SPECTRUM_EVERY_S = 0.5
_SHOWN_S = 30.0  # of a run that was under way before the viewer came


@router.get(
    "/benches/{bench}/live",
    name="live",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/event-stream": {"schema": {"type": "string"}}}}},
)
async def live(
    bench: BenchName,
    service: TheService,
    me: Viewer,
    still: Still,
    channel: Annotated[list[ChannelName] | None, Query(max_length=24)] = None,
) -> StreamingResponse:
    """A bench as it changes: `state`, `samples`, `spectrum`, `criteria`, `marks` (docs/reference/api.md)."""
    known(service, bench)
    if len(service.live_hub.viewers[bench]) >= _MOST_VIEWERS:
        raise RefusedError(429, f"the limit of {_MOST_VIEWERS} viewers is reached")
    return StreamingResponse(
        _Watching(service, bench, me.name, still, channel or CHANNELS).events(),
        media_type="text/event-stream",
    )


class _Watching:
    """One viewer of one bench."""

    def __init__(
        self, service: Service, bench: str, name: str, still: Callable[[], bool], channels: Sequence[str]
    ) -> None:
        self._service, self._bench, self._cache = service, bench, service.live_hub.caches[bench]
        self._name, self._still = name, still
        self._channels = tuple(dict.fromkeys(channels))
        self._marks: object = None
        self._run = -1
        self._next_bucket = 0
        self._version = -1
        self._criteria: object = None
        self._spectrum_s = self._spectrum_at_s = 0.0

    async def events(self) -> AsyncIterator[str]:
        """Whatever is new, as long as somebody takes it; a sender that has to wait skips nothing but time."""
        woken, viewers = asyncio.Event(), self._service.live_hub.viewers[self._bench]
        viewers[woken] = self._name
        self._service.changed(self._bench)
        try:
            while not self._service.closing:
                woken.clear()
                if not await in_turns(self._may_look()):
                    yield _event("signed_out", {})
                    return
                news = "".join(await in_turns(self._news()))
                yield news or _event("here", {})
                await asyncio.sleep(_SHORTEST_S)
                try:
                    await asyncio.wait_for(woken.wait(), _LONGEST_S)
                except TimeoutError:
                    continue
        finally:
            viewers.pop(woken, None)
            self._service.changed(self._bench)

    async def _may_look(self) -> bool:
        return self._still()

    async def _news(self) -> list[str]:
        service, bench, hub = self._service, self._bench, self._service.live_hub
        news = []
        if hub.version(bench) != self._version:
            self._version, state = await self._cache.state(
                lambda: hub.version(bench), lambda: _event("state", _state(service, bench))
            )
            news.append(state)
        shown = hub.run_of(bench)
        if shown is not None:
            news += self._of_run(shown)
        return news

    def _of_run(self, shown: LiveView) -> list[str]:
        news, buckets, run = [], shown.live.buckets, shown.run
        if run != self._run:
            self._run, self._criteria, self._marks = run, None, None
            self._next_bucket = max(0, buckets.shown - round(_SHOWN_S / BUCKET_S))
        first, self._next_bucket = self._next_bucket, max(self._next_bucket, buckets.shown)
        if self._next_bucket > first:
            news.append(self._samples(shown, first))
        if shown.criteria is not self._criteria:
            self._criteria = shown.criteria
            decided = [_criterion(one) for one in shown.criteria]
            news.append(_event("criteria", {"run": run, "criteria": decided}))
        if (marks := (run, *shown.live.marks)) != self._marks:
            self._marks = marks
            news.append(self._cache.text("marks", marks, lambda: _marks(shown)))
        return [*news, self._spectrum(shown)]

    def _samples(self, shown: LiveView, first: int) -> str:
        """The channels chosen; of a stretch that is long, as of who has just come, in wider buckets."""
        buckets = shown.live.buckets
        names = [name for name in self._channels if name in buckets.names]
        if self._next_bucket - first <= MOST_BUCKETS:
            first = max(first, buckets.oldest)
            start_s, width_s = first * BUCKET_S, BUCKET_S
            texts = [shown.texts.of(name, first, self._next_bucket) for name in names]
        else:
            stretch = buckets.since(first)
            if stretch is None:
                return ""
            start_s, width_s = stretch.start_s, stretch.width_s
            texts = [_channel(stretch, name) for name in names]
        begin = f'"run":{shown.run},"start_s":{start_s:.3f},"width_s":{width_s:.3f}'
        return f'event: samples\ndata: {{{begin},"channels":{{{",".join(texts)}}}}}\n\n'

    def _spectrum(self, shown: LiveView) -> str:
        now_s = time.monotonic()
        if now_s - self._spectrum_at_s < _SPECTRUM_EVERY_S or shown.live.time_s == self._spectrum_s:
            return ""
        self._spectrum_at_s, self._spectrum_s = now_s, shown.live.time_s
        of = (shown.run, shown.live.time_s)
        return self._cache.text("spectrum", of, lambda: _spectrum(shown.run, shown.live.spectrum()))


def _state(service: Service, bench: str) -> dict[str, Any]:
    running = service.running(bench)
    run = service.with_progress(running.data) if running else None
    return {
        "bench": service.bench_data(bench).model_dump(mode="json"),
        "running": run.model_dump(mode="json") if run else None,
        "message": running.message if running else "",
        "viewers": service.live_hub.names_of_viewers(bench),
        "queue": [one.model_dump(mode="json") for one in service.waiting(bench).runs],
    }


def _channel(stretch: Stretch, name: str) -> str:
    column = stretch.names.index(name)
    values = {
        "lowest": numbers(stretch.lowest[:, column]),
        "highest": numbers(stretch.highest[:, column]),
    }
    return f"{json.dumps(name)}:{_json(values)}"


def _marks(shown: LiveView) -> str:
    overview = shown.live.overview()
    found = marks_of(overview.tables, overview) if overview else []
    return _event("marks", {"run": shown.run, "marks": found})


def _spectrum(run: int, found: Spectrum | None) -> str:
    if found is None:
        return ""
    values = {"step_hz": found.step_hz, "density": numbers(found.density)}
    return _event("spectrum", {"run": run, "band_energy": found.band_energy, **values})


def _criterion(one: CriterionResult) -> dict[str, Any]:
    return one.model_dump(mode="json", exclude={"definition"}) | {"margin": one.margin}


def _event(name: str, data: dict[str, Any]) -> str:
    return f"event: {name}\ndata: {_json(data)}\n\n"


def _json(data: dict[str, Any]) -> str:
    return json.dumps(data, allow_nan=False, separators=(",", ":"))
