"""Numbers of the base model that were wrong: corrected a little, or identified anew from the start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import channel_gaps
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import simulated_samples
from hil.analysis.diagnosis.fit.thresholds import TOLERANCE
from hil.analysis.diagnosis.search.from_base import moved
from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.tell.result import NamedEffect, Start
from hil.core.effects import EFFECTS
from hil.core.errors.wording import multiple
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]

#: A number as it was, as it is now, its standard error.
Correction = tuple[float, float, float]


def updates(found: Found, kept: Fit, errors: Array) -> dict[str, Correction]:
    """Corrections of base parameters beyond what noise explains."""
    model = kept.hypothesis.model(kept.theta)
    base = kept.hypothesis.base.parameters
    wrong = {
        use.values["parameter"]
        for use in model.effects
        if use.id == "parameter_mismatch" and not is_correction(found, use, kept)
    }
    corrected = {}
    if kept.hypothesis.far:
        wrong |= {*moved(kept)}  # under `start`
    for c, error in zip(kept.hypothesis.coordinates(), errors, strict=True):
        if c.term >= 0 or c.name in wrong:
            continue
        old, new = base[c.name], model.parameters[c.name]
        if abs(np.log(new / old)) < 2.0 * error:
            continue
        corrected[c.name] = (old, new, new * float(error))
    return corrected


def suiting_a_gap(corrected: Mapping[str, Correction], gaps: Mapping[str, float]) -> list[str]:
    """What to say of corrections beside a gap that stays: least squares bend numbers to it.

    Args:
        corrected: from `updates`.
        gaps: in noises, of the channels that stay open.
    """
    if not (corrected and gaps):
        return []
    worst = max(gaps, key=lambda channel: gaps[channel])
    left = f"{multiple(gaps[worst])} its noise left in {worst}"
    suits, theirs = (
        ("it suits", "its standard error") if len(corrected) == 1 else ("they suit", "their standard errors")
    )
    return [
        f"{', '.join(corrected)} of the base model moved with {left}: {suits} what is missing as well, "
        f"and may be off by far more than {theirs}"
    ]


def is_correction(found: Found, mismatch: EffectUse, kept: Fit) -> bool:
    """Whether a parameter is off by no more than its tolerance, or it cannot be stated that it is.

    Beside friction or contact by a law that is not quite the right one a parameter makes up for what the
    formula misses, as a shafts' damping does for flanks that damp otherwise.
    """
    if _within_tolerance(mismatch, kept.hypothesis.base.parameters):
        return True
    return kept.hypothesis.of_many_laws and not found.evidence.closed(kept)


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


def started(problem: Problem, found: Found, kept: Fit, errors: Array, floor: Array) -> Start | None:
    """The numbers that had to change where the base model was far off, as they are in the end."""
    if not kept.hypothesis.far:
        return None
    given, new = kept.hypothesis.base.parameters, kept.hypothesis.model(kept.theta).parameters
    wrong = moved(kept)
    parameters = {
        c.name: (given[c.name], new[c.name], new[c.name] * float(error))
        for c, error in zip(kept.hypothesis.coordinates(), errors, strict=True)
        if c.term < 0 and c.name in wrong
    }
    base = found.base
    shown = simulated_samples(problem, base.hypothesis, base.theta, base.starts)
    names = tuple(t.name for t in problem.traces)
    return Start(parameters, names, channel_gaps(problem.traces, floor, shown))


def _within_tolerance(use: EffectUse, base: dict[str, float]) -> bool:
    """Whether a parameter is off by no more than its stated calibration tolerance."""
    ratio = float(use.values["value"]) / base[str(use.values["parameter"])]
    return bool(abs(np.log(ratio)) <= TOLERANCE)
