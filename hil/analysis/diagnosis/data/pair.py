"""Two things that go together, by their sums alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass
class Pair:
    """Sums of squares and of products of two things that go together: `y` should equal `x`."""

    xx: float = 0.0
    yy: float = 0.0
    xy: float = 0.0
    count: int = 0

    def add(self, x: Array, y: Array) -> None:
        """Count readings of both."""
        self.xx, self.yy, self.xy = self.xx + float(x @ x), self.yy + float(y @ y), self.xy + float(x @ y)
        self.count += len(x)

    @property
    def correlation(self) -> float:
        """Cosine between the two: 1 for equal, -1 for opposite ones."""
        return self.xy / max(float(np.sqrt(self.xx * self.yy)), 1e-30)

    @property
    def factor(self) -> float:
        """How much larger y is than x; noise in either makes no difference to first order."""
        return float(np.sqrt(self.yy / max(self.xx, 1e-30)))

    @property
    def sizes(self) -> tuple[float, float]:
        """Rms of x and of y."""
        count = max(self.count, 1)
        return float(np.sqrt(self.xx / count)), float(np.sqrt(self.yy / count))
