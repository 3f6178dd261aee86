"""Frames a second through each transport, both ends in one thread: `python -m benchmarks.transports`."""

from __future__ import annotations

import contextlib
import time

from drivers import Wire, open_can
from hil.core.runtime.clock import WallClock
from tests.transports.far_ends import FAR_ENDS, block_of, looked_after

_FRAMES, _AT_ONCE = 20_000, 40  # ten milliseconds of a busy bus
_SILENT_S = 2.0


def main() -> None:
    for name, make in FAR_ENDS.items():
        far = make()
        with looked_after(far) if hasattr(far, "server") else contextlib.nullcontext():
            wire = Wire("bus", open_can(far.settings), WallClock())
        sent = _sent(wire, far)
        received = (
            "as fast as it is computed" if name == "hil-sim" else f"{_received(wire, far):9,.0f} received/s"
        )
        print(f"{name:12} {sent:9,.0f} sent/s, {received}")
        wire.close()
        far.leave()


def _sent(wire, far) -> float:  # type: ignore[no-untyped-def]
    start, arrived = time.perf_counter(), 0
    for first in range(0, _FRAMES, _AT_ONCE):
        for _ in range(_AT_ONCE):
            wire.send(0x100, b"12345678")
        arrived += len(far.taken())
        if first % 1000 == 0:
            wire.drain()
    end_s = time.perf_counter() + _SILENT_S
    while arrived < _FRAMES and time.perf_counter() < end_s:
        arrived += len(far.taken())
        wire.drain()
    return arrived / (time.perf_counter() - start)


def _received(wire, far) -> float:  # type: ignore[no-untyped-def]
    wire.drain()
    block = block_of(range(0x100, 0x100 + _AT_ONCE), stamp_s=time.time())
    start, arrived = time.perf_counter(), 0
    for _ in range(0, _FRAMES, _AT_ONCE):
        far.put(block)
        arrived += len(wire.drain())
    end_s = time.perf_counter() + _SILENT_S
    while arrived < _FRAMES and time.perf_counter() < end_s:
        far.taken()
        arrived += len(wire.drain())
    return arrived / (time.perf_counter() - start)


if __name__ == "__main__":
    main()
