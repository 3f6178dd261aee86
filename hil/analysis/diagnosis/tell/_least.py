"""Effects that are there and do not matter: smaller than what a bench's instruments are good to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hil.analysis.diagnosis.data._trace import Trace
from hil.analysis.diagnosis.fit._thresholds import TOLERANCE
from hil.analysis.diagnosis.tell._thresholds import OF_A_FILTER, TOLERANCES
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model


def belongs_to_filter(use: EffectUse, beside: Sequence[EffectUse], dt: float) -> bool:
    """Whether a channel that is early is only what a filter that runs with the samples does.

    Such a filter, y += share·(x - y), passes a share of the newest sample at once: a low-pass of its time
    constant, but for an advance of half a sample.
    """
    if use.id != "channel_skew" or not -OF_A_FILTER * dt <= float(use.values["delay_s"]) < 0.0:
        return False
    return any(e.id == "sensor_lag" and e.values["channel"] == use.values["channel"] for e in beside)


def worth_naming(use: EffectUse, traces: Sequence[Trace], least: Mapping[str, float], base: Model) -> bool:
    """Whether an effect is at least as large as the smallest size worth a name.

    An extra dead time adds to the model's own, and is no finding within what that may be off by.

    Args:
        least: sizes that a user set, by effect, in the unit of the effect's first number.
    """
    effect = EFFECTS[use.id]
    known = effect.completed(use.values)
    size = max(abs(float(known[name]) - effect.off) for name in effect.acting())
    if use.id in least:
        return size >= least[use.id]
    if use.id == "dead_time":
        own = base.dead_time_s * base.tolerance.get("torque_delay", TOLERANCE)
        if size < TOLERANCES * own:
            return False
    if effect.least is None:
        return True
    unit = 1.0
    if effect.least.of == "samples":
        unit = traces[0].dt
    elif effect.least.of == "largest torque":
        unit = max(float(np.max(np.abs(t.torque))) for t in traces)
    elif effect.least.of == "rms reading":
        column = OUTPUTS.index(str(use.values["channel"]))
        readings = np.concatenate([t.samples[:, column] for t in traces if t.has[column]])
        unit = float(np.sqrt(np.mean(readings**2)))
    return size >= effect.least.amount * unit
