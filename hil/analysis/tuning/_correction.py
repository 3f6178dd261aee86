"""What runs have shown of margins beside what was predicted: output space mapping.

J. W. Bandler et al., "Space mapping: the state of the art", IEEE Trans. Microwave Theory Tech. 52 (2004)
337: a coarse model, here the predicted run, is corrected so that it agrees with the fine one, here the bench,
where that was tried.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

#: Runs closer together than this, in ranges of the parameters, say less of a slope than of their noise.
_TOO_NEAR = 0.05


@dataclass(frozen=True)
class Correction:
    """Measured less predicted margins, exact at `centre`, with the slope that earlier runs show.

    `offset` has one number for each margin, `slope` a row for each margin and a column for each parameter.
    """

    centre: Array
    offset: Array
    slope: Array

    def at(self, point: Array) -> Array:
        """What is to be added to the margins that are predicted at a point of the unit cube."""
        return np.asarray(self.offset + self.slope @ (point - self.centre))


def correction_of(points: list[Array], apart: list[Array], centre: int) -> Correction:
    """From runs at `points`, of which measured and predicted margins were `apart`; exact at `centre`.

    The slope is the least one that explains the other runs, by ridge regression: a direction in which nothing
    was tried has none.
    """
    middle, offset = points[centre], apart[centre]
    others = [number for number in range(len(points)) if number != centre]
    steps = np.array([points[number] - middle for number in others]).reshape(-1, middle.size)
    changes = np.array([apart[number] - offset for number in others]).reshape(-1, offset.size)
    near = steps.T @ steps + _TOO_NEAR**2 * np.eye(middle.size)
    return Correction(middle, offset, np.linalg.solve(near, steps.T @ changes).T)
