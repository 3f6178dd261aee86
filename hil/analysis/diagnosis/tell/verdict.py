"""Whether what was found closes the gap."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.tell.result import Verdict
from hil.analysis.diagnosis.tell.thresholds import (
    CHANNEL_NOISES,
    CHANNEL_SHUT,
    HALVED,
    LEFT_NOISELESS,
    MORE,
    NOISELESS,
    NOT_WORSE,
    SHUT,
    SHUT_BY_LAW,
    SHUT_NOISELESS,
    UNSEEN,
)
from hil.core.effects import EFFECTS

Array = npt.NDArray[np.float64]

_BY_LAW = tuple(effect.id for effect in EFFECTS.values() if effect.many_laws)


def verdict_of(found: Found, rounded: bool) -> Verdict:
    """Named if the accepted effects close the gap, in each channel, unknown if a gap stays, else none."""
    evidence, best = found.evidence, found.best
    ids = best.hypothesis.ids
    if not ids:
        return verdict_without_effects(evidence.closed(best), rounded)
    base = found.given or found.base
    apart = evidence.problem.functions is not None
    if any(open_channels(ids, evidence.gaps(base), evidence.gaps(best), apart)):
        return "unknown"
    if found.clear:
        return "named"
    if _no_better_than_numbers(found):
        return "unknown"
    return verdict_on(ids, evidence.worst(found.base), evidence.share(best), evidence.worst(best))


def _no_better_than_numbers(found: Found) -> bool:
    """Whether other numbers of the base model alone leave no more than the effects, which leave a gap."""
    if found.numbers is None or found.settled:
        return False
    return found.evidence.left(found.numbers) <= found.evidence.left(found.best)


def open_channels(ids: Sequence[str], before: Array, after: Array, apart: bool) -> list[bool]:
    """Which channels keep a gap that the named effects do not account for.

    Args:
        ids: of the effects.
        before: gap over noise of each channel with the base model, shape (3,).
        after: the same with the effects.
        apart: each channel has a function of its own.
    """
    if float(np.max(before)) > NOISELESS:
        # A matter of formulas. One chain may miss a channel that no chain meets, but not make it worse; where
        # each channel has its own function nothing stands between an effect and any of them.
        most = LEFT_NOISELESS if apart else NOT_WORSE
        return [bool(more) for more in after > np.maximum(CHANNEL_NOISES, most * before)]
    before, after = before**2 - 1.0, after**2 - 1.0  # powers over that of the noise add, ratios do not
    least = SHUT_BY_LAW if any(id_ in _BY_LAW for id_ in ids) else CHANNEL_SHUT
    bound = np.maximum(CHANNEL_NOISES**2 - 1.0, (1.0 - least) * before)
    halved = (after <= HALVED**2 * before) | (after <= UNSEEN**2 - 1.0)
    return [not fine for fine in ((after <= bound) & halved).tolist()]


def verdict_without_effects(closed: bool, rounded: bool) -> Verdict:
    """The verdict where no effect was accepted.

    Args:
        closed: nothing but noise is left.
        rounded: a channel's rounding was found: it is named, though no fit needs it.
    """
    if not closed:
        return "unknown"
    return "named" if rounded else "none"


def verdict_on(ids: Sequence[str], before: float, share: float, left: float) -> Verdict:
    """The verdict on accepted effects.

    Args:
        ids: of the effects.
        before: gap over noise of the channel that is worst off, without them.
        share: of the gap's power that they close.
        left: gap over noise that they leave in the channel that is worst off.
    """
    if before > NOISELESS:
        return "named" if share > SHUT_NOISELESS else "unknown"
    limits = SHUT
    if any(id_ in _BY_LAW for id_ in ids):
        limits = (*SHUT, (SHUT_BY_LAW, np.inf))
    least_more = MORE * (len(ids) - 1)
    shut = any(share > least + least_more and left < most for least, most in limits)
    return "named" if shut else "unknown"
