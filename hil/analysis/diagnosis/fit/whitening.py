"""Filters that make coloured errors white."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.linalg import toeplitz

from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.thresholds import WHITENING_ORDER

Array = npt.NDArray[np.float64]


def whitening_of(of_recordings: Sequence[Errors]) -> Array:
    """Filters (3 x order + 1) that make the errors of a fit white with unit variance, one a channel.

    Autoregression by the Yule-Walker equations over all recordings.
    """
    filters = np.zeros((3, WHITENING_ORDER + 1))
    filters[:, 0] = 1.0
    errors = [one.channels for one in of_recordings]
    for column in range(3):
        rows = [e[:, column] for e in errors]
        count = sum(len(e) for e in rows)
        products = [
            sum(float(e[lag:] @ e[: len(e) - lag]) for e in rows) / count
            for lag in range(WHITENING_ORDER + 1)
        ]
        if products[0] <= 0.0:
            continue
        matrix = toeplitz(products[:-1]) + 1e-6 * products[0] * np.eye(WHITENING_ORDER)
        past = np.linalg.solve(matrix, products[1:])
        variance = max(products[0] - float(past @ products[1:]), 1e-6 * products[0])
        filters[column, 0] = 1.0
        filters[column, 1:] = -past
        filters[column] /= np.sqrt(variance)
    return filters
