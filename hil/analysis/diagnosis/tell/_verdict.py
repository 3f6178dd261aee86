"""Whether what was found closes the gap."""

from __future__ import annotations

import numpy as np

from hil.analysis.diagnosis.search._search import Found
from hil.analysis.diagnosis.tell._result import Verdict

#: Named effects close at least this share of the gap's power, and leave at most this factor over the noise:
#: a large effect may be closed less finely, because its formula is never quite that of the axle.
_SHUT = ((0.5, 1.03), (0.95, 1.6), (0.995, np.inf))
#: Laws of contact, dry friction and hysteresis are many: such an effect is named from this share on.
_BY_LAW = ("backlash", "coulomb_friction", "shaft_hysteresis")
_SHUT_BY_LAW = 0.9
_NOISELESS = 100.0  # gap over noise: what is left is a matter of formulas, not of noise
_SHUT_NOISELESS = 0.9
_MORE = 0.001  # of the share for each further name


def verdict_of(found: Found, rounded: bool) -> Verdict:
    """Named if the accepted effects close the gap, unknown if a gap stays, else none."""
    evidence, best = found.evidence, found.best
    if best.hypothesis.terms:
        share, worst = evidence.share(best), evidence.worst(best)
        if evidence.worst(found.base) > _NOISELESS:
            return "named" if share > _SHUT_NOISELESS else "unknown"
        several = len(best.hypothesis.terms) - 1
        limits: tuple[tuple[float, float], ...] = _SHUT
        if any(id_ in _BY_LAW for id_ in best.hypothesis.ids):
            limits = (*_SHUT, (_SHUT_BY_LAW, np.inf))
        shut = any(share > least + _MORE * several and worst < most for least, most in limits)
        return "named" if shut else "unknown"
    if not evidence.closed(best):
        return "unknown"
    return "named" if rounded else "none"
