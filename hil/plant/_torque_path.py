"""The torque path but for its delay and lag, sample by sample: what replays of many models begin with."""

from __future__ import annotations

import math

from hil.core.runtime.compiled import compiled
from hil.plant import _laws as L
from hil.plant.kernel import as_tuple


@compiled
def over_samples(torque, dt, p, out, ends):  # type: ignore[no-untyped-def]
    """The torque path but for its delay and lag: the torque over each sample and at its end."""
    reach = L.steepest(p) * dt
    slewed = 0.0
    for k in range(torque.shape[0]):
        wanted = L.shaped(torque[k], p)
        if k == 0:
            slewed = wanted
        gap = wanted - slewed
        if abs(gap) <= reach:  # arrives within the sample: the mean over it
            out[k] = wanted - gap * abs(gap) / (2.0 * reach) if reach < math.inf and gap != 0.0 else wanted
            slewed = wanted
        else:
            moved = slewed + math.copysign(reach, gap)
            out[k] = 0.5 * (slewed + moved)
            slewed = moved
        ends[k] = slewed


@compiled
def shape(torque, dt, vector, out, ends):  # type: ignore[no-untyped-def]
    """`over_samples` of a packed model."""
    over_samples(torque, dt, as_tuple(vector), out, ends)
