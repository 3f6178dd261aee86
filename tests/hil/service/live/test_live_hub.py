"""What many viewers are sent is made once, though the store lets them wait while it is read."""

from __future__ import annotations

import asyncio
import time

from hil.service.live.live_hub import BroadcastCache
from hil.service.store import asked_apart, in_turns


@asked_apart
class _Store:
    def __init__(self) -> None:
        self.asked = 0

    def runs(self) -> int:
        time.sleep(0.002)  # long enough for all to come
        self.asked += 1
        return self.asked


async def _seen_by(viewers: int, cache: BroadcastCache, store: _Store, version: int) -> set[tuple[int, str]]:
    async def look() -> tuple[int, str]:
        return await cache.state(lambda: version, lambda: f"{store.runs()} runs")

    return set(await asyncio.gather(*(in_turns(look()) for _ in range(viewers))))


def test_a_state_is_read_once_for_all_viewers_of_a_version():
    async def watched() -> None:
        cache, store = BroadcastCache(), _Store()
        assert await _seen_by(50, cache, store, 1) == {(1, "1 runs")}
        assert await _seen_by(50, cache, store, 1) == {(1, "1 runs")}
        assert await _seen_by(50, cache, store, 2) == {(2, "2 runs")}
        assert store.asked == 2

    asyncio.run(watched())


def test_a_viewer_that_leaves_while_it_is_read_leaves_it_to_the_others():
    async def watched() -> None:
        cache, store = BroadcastCache(), _Store()
        first = asyncio.create_task(_seen_by(1, cache, store, 1))
        await asyncio.sleep(0)
        others = asyncio.create_task(_seen_by(3, cache, store, 1))
        await asyncio.sleep(0.0005)
        first.cancel()
        assert {version for version, _ in await others} == {1}

    asyncio.run(watched())
