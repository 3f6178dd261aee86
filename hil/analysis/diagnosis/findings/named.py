"""Which effects are worth a name: what is smaller than a bench's instruments are good to is a correction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hil.analysis.diagnosis.findings.result import NamedEffect
from hil.analysis.diagnosis.findings.thresholds import TOLERANCES
from hil.analysis.missing_effects import TOLERANCE, Series
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model

#: A number as it was, as it is now, its standard error.
Correction = tuple[float, float, float]


def worth_naming(use: EffectUse, traces: Sequence[Series], least: Mapping[str, float], base: Model) -> bool:
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


def as_corrections(small: Sequence[NamedEffect]) -> dict[str, Correction]:
    """Effects too small to be named, as corrections of numbers that were where they do nothing."""
    found = {}
    for effect in small:
        about = [str(v) for v in effect.use.values.values() if isinstance(v, str)]
        for name, error in effect.standard_error.items():
            neutral = EFFECTS[effect.use.id].off if name in EFFECTS[effect.use.id].acting() else 0.0
            key = ".".join([effect.use.id, *about, name])
            found[key] = (neutral, float(effect.use.values[name]), error)
    return found


def clean(use: EffectUse) -> EffectUse:
    """Phases within ±π; optional values that were not fitted left out."""
    values = dict(use.values)
    if "phase_rad" in values:
        values["phase_rad"] = float((float(values["phase_rad"]) + np.pi) % (2 * np.pi) - np.pi)
    for parameter in EFFECTS[use.id].parameters:
        if parameter.optional and values.get(parameter.name) == parameter.default:
            del values[parameter.name]
    return EffectUse(use.id, values)
