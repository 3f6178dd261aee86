"""Whether what was found closes the gap."""

from __future__ import annotations

import numpy as np

from hil.analysis.diagnosis.search._search import Found
from hil.analysis.diagnosis.tell._result import Verdict
from hil.analysis.diagnosis.tell._thresholds import MORE, NOISELESS, SHUT, SHUT_BY_LAW, SHUT_NOISELESS

_BY_LAW = ("backlash", "coulomb_friction", "shaft_hysteresis")


def verdict_of(found: Found, rounded: bool) -> Verdict:
    """Named if the accepted effects close the gap, unknown if a gap stays, else none."""
    evidence, best = found.evidence, found.best
    if best.hypothesis.terms:
        share, worst = evidence.share(best), evidence.worst(best)
        if evidence.worst(found.base) > NOISELESS:
            return "named" if share > SHUT_NOISELESS else "unknown"
        several = len(best.hypothesis.terms) - 1
        limits: tuple[tuple[float, float], ...] = SHUT
        if any(id_ in _BY_LAW for id_ in best.hypothesis.ids):
            limits = (*SHUT, (SHUT_BY_LAW, np.inf))
        shut = any(share > least + MORE * several and worst < most for least, most in limits)
        return "named" if shut else "unknown"
    if not evidence.closed(best):
        return "unknown"
    return "named" if rounded else "none"
