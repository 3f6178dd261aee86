"""Weighted errors of a fit, by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Errors:
    """Measured minus simulated of one recording in noise levels, and how the simulation changes.

    `rows` are blocks x 3, flattened, 0 where not measured; `by_coordinate` (rows x coordinates) and
    `by_start` (rows x initial values) are derivatives of the weighted simulation.
    """

    rows: Array
    by_coordinate: Array
    by_start: Array

    @property
    def channels(self) -> Array:
        """The errors as blocks x 3."""
        return self.rows.reshape(-1, 3)

    @property
    def slopes(self) -> Array:
        """`by_coordinate` without what initial values would take up."""
        if not np.any(self.by_start):
            return self.by_coordinate
        basis = np.linalg.qr(self.by_start)[0]
        return np.asarray(self.by_coordinate - basis @ (basis.T @ self.by_coordinate))
