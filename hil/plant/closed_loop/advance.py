"""Many ticks in one call, for the wire and for predictions; what the RMCU was asked may change with each."""

from __future__ import annotations

from hil.core.runtime.compiled import compiled, uncounted
from hil.plant import kernel as K
from hil.plant.closed_loop.tick import tick


@compiled
def advance(  # type: ignore[no-untyped-def]
    first,
    x,
    form,
    vector,
    w,
    torques,
    fir,
    drives,
    sensors,
    past,
    noise,
    modes,
    requests,
    codes,
    status,
    rows,
):
    """Execute `tick` for sample `first` and those that follow it, one for each of `modes`.

    `form` is a state at rest, whose length says how many numbers of `x` move. `rows` has a row, `requests`
    and `codes` have an entry for each sample; `noise` has a row for each, or one for all. Drives keep their
    last request.
    """
    # what is cut out of an array in each tick is not counted: that took half of a tick's time
    x, w, torques, status = uncounted(x), uncounted(w), uncounted(torques), uncounted(status)
    drives, sensors, past = uncounted(drives), uncounted(sensors), uncounted(past)
    noise, rows = uncounted(noise), uncounted(rows)
    b, a, z, gains, states = fir
    fir = uncounted(b), uncounted(a), uncounted(z), uncounted(gains), uncounted(states)
    p = K.as_tuple(vector)  # once: to make it takes as long as half a millisecond's tick
    each = 1 if noise.shape[0] > 1 else 0
    for i in range(modes.shape[0]):
        tick(
            first + i,
            x,
            form,
            p,
            w,
            torques,
            fir,
            drives,
            sensors,
            past,
            noise[each * i],
            modes[i],
            requests[i],
            codes[i],
            status,
            rows[i],
        )
