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
