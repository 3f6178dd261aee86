"""Many ticks at once: the loop of the simulated bench without the wire."""

from __future__ import annotations

from hil.core.compiled import compiled
from hil.plant.closed_loop.tick import tick


@compiled
def advance(  # type: ignore[no-untyped-def]
    first, x, vector, w, torques, fir, drives, sensors, past, noise, mode, requests, code, status, rows
):
    """Carry out a tick for each of `requests` (N m, of what `mode` asks) from sample `first` on.

    Drives keep what they were told; row i of `rows` is filled with sample `first` + i.
    """
    for i in range(requests.shape[0]):
        tick(
            first + i,
            x,
            vector,
            w,
            torques,
            fir,
            drives,
            sensors,
            past,
            noise,
            mode,
            requests[i],
            code,
            status,
            rows[i],
        )
