"""What stays of a turning mass as a torque, over speed and over angle: a picture of what has no name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._balance import latent_torque
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._outcome import Curve
from hil.analysis.missing_effects._series import Series

Array = npt.NDArray[np.float64]

_BINS = 24


def curves_of(hypothesis: Hypothesis, series: Sequence[Series]) -> tuple[Curve, ...]:
    """The latent torque that a hypothesis leaves on the rotor, over speed and over the angle within a turn.

    The one that explains more comes first. Empty for chains with shafts, or without a speed.
    """
    latent = latent_torque(hypothesis, series)
    if latent is None:
        return ()
    torque, speed, angle = latent
    found = (
        _curve("speed in rad/s", speed, torque),
        _curve("angle within a turn in rad", angle % (2.0 * np.pi), torque),
    )
    return tuple(sorted(found, key=lambda one: -one.share))


def _curve(over: str, at: Array, torque: Array) -> Curve:
    """Means of the torque in bins of equal count, and the share of its variance that they explain."""
    edges = np.unique(np.quantile(at, np.linspace(0.0, 1.0, _BINS + 1)))
    place = np.clip(np.searchsorted(edges, at, side="right") - 1, 0, max(len(edges) - 2, 0))
    count = np.maximum(np.bincount(place), 1)
    mean, middle = (np.bincount(place, values) / count for values in (torque, at))
    spread = float(np.mean(torque**2))
    left = float(np.mean((torque - mean[place]) ** 2))
    return Curve("rotor", over, middle, mean, 1.0 - left / max(spread, 1e-300))
