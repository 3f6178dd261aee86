"""The torque path but for its delay and lag, sample by sample: what replays of many models begin with."""

from __future__ import annotations

import math

from hil.core.runtime.compiled import compiled, inlined
from hil.plant import _laws as L
from hil.plant.kernel import as_tuple


@compiled
def over_samples(torque, dt, p, out, ends):  # type: ignore[no-untyped-def]
    """The torque path but for its delay and lag: the torque over each sample and at its end."""
    reach = L.steepest(p) * dt
    slewed = L.shaped(torque[0], p)
    for k in range(torque.shape[0]):
        out[k], slewed = slewed_over(L.shaped(torque[k], p), slewed, reach)
        ends[k] = slewed


@inlined
def slewed_over(wanted, slewed, reach):  # type: ignore[no-untyped-def]
    """Mean over a sample, and value at its end, of a torque that goes by `reach` at most in it."""
    gap = wanted - slewed
    if abs(gap) <= reach:  # arrives within the sample
        mean = wanted - gap * abs(gap) / (2.0 * reach) if reach < math.inf and gap != 0.0 else wanted
        return mean, wanted
    moved = slewed + math.copysign(reach, gap)
    return 0.5 * (slewed + moved), moved


@compiled
def shape(torque, dt, vector, out, ends):  # type: ignore[no-untyped-def]
    """`over_samples` of a packed model."""
    over_samples(torque, dt, as_tuple(vector), out, ends)
