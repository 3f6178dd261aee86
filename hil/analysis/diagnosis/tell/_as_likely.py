"""Other models that the recordings allow as well as the one that was fitted: how well a figure is known."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.tell._thresholds import DRAWN_MODELS
from hil.core.model import Model

Array = npt.NDArray[np.float64]


def as_likely(kept: Fit, errors: Array) -> list[Model]:
    """Models drawn from what a fit knows of its numbers, within their bounds; the same ones every time.

    Args:
        errors: standard errors of the coordinates, that count the misfit that is left; correlations are those
            of the fit.
    """
    coordinates = kept.hypothesis.coordinates()
    if not coordinates:
        return []
    plain = np.sqrt(np.maximum(np.diag(kept.covariance), 1e-300))
    scaled = kept.covariance * np.outer(errors / plain, errors / plain)
    values, axes = np.linalg.eigh(scaled)
    rng = np.random.default_rng(0)
    drawn = rng.standard_normal((DRAWN_MODELS, len(values))) * np.sqrt(np.maximum(values, 0.0)) @ axes.T
    lower, upper = (np.array([getattr(c, side) for c in coordinates]) for side in ("lower", "upper"))
    return [kept.hypothesis.model(np.clip(kept.theta + step, lower, upper)) for step in drawn]
