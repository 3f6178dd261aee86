"""Weighted errors of a fit, by name."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

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
        return self.without_starts(self.by_coordinate)

    def without_starts(self, values: Array) -> Array:
        """`values` (rows, or rows x any) without what initial values would take up."""
        if not np.any(self.by_start):
            return values
        return np.asarray(values - self._of_starts @ (self._of_starts.T @ values))

    @cached_property
    def _of_starts(self) -> Array:
        """Orthonormal, rows x initial values."""
        return np.asarray(np.linalg.qr(self.by_start)[0])
