"""Many ticks in one call, for the wire and for predictions; what the RMCU was asked may change with each."""

from __future__ import annotations

from hil.core.compiled import compiled
from hil.plant import _kernel as K
from hil.plant.closed_loop.tick import tick


@compiled
def advance(  # type: ignore[no-untyped-def]
    first, x, vector, w, torques, fir, drives, sensors, past, noise, modes, requests, codes, status, rows
):
    """Carry out `tick` for sample `first` and those that follow it, one for each of `modes`.

    `noise` and `rows` have a row, `requests` and `codes` an entry for each sample. Drives keep what they were
    told.
    """
    p = K.as_tuple(vector)  # once: to make it takes as long as half a millisecond's tick
    for i in range(modes.shape[0]):
        tick(
            first + i,
            x,
            p,
            w,
            torques,
            fir,
            drives,
            sensors,
            past,
            noise[i],
            modes[i],
            requests[i],
            codes[i],
            status,
            rows[i],
        )
