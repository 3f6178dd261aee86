"""Whether what is named closes the gap of every channel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.findings.thresholds import (
    CHANNEL_NOISES,
    CHANNEL_SHUT,
    HALVED,
    NOISELESS,
    NOT_WORSE,
    SHUT_BY_LAW,
    UNSEEN,
)
from hil.core.effects import EFFECTS

Array = npt.NDArray[np.float64]

_BY_LAW = tuple(effect.id for effect in EFFECTS.values() if effect.many_laws)


def open_channels(ids: Sequence[str], before: Array, after: Array) -> list[bool]:
    """Which channels keep a gap that the named effects do not account for.

    Args:
        ids: of the effects.
        before: gap over noise of each channel with the base model, shape (3,).
        after: the same with the effects.
    """
    if float(np.max(before)) > NOISELESS:
        # A matter of formulas: a chain may miss a channel that no chain meets, but not make it worse.
        return [bool(more) for more in after > np.maximum(CHANNEL_NOISES, NOT_WORSE * before)]
    before, after = before**2 - 1.0, after**2 - 1.0  # powers over that of the noise add, ratios do not
    least = SHUT_BY_LAW if any(id_ in _BY_LAW for id_ in ids) else CHANNEL_SHUT
    bound = np.maximum(CHANNEL_NOISES**2 - 1.0, (1.0 - least) * before)
    halved = (after <= HALVED**2 * before) | (after <= UNSEEN**2 - 1.0)
    return [not fine for fine in ((after <= bound) & halved).tolist()]
