"""Numbers as JSON has them: what is no number is null."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

_DIGITS = 6


def number(value: float | None) -> float | None:
    """A number as it is, null for what is none."""
    return None if value is None or not np.isfinite(value) else float(value)


def numbers(values: npt.ArrayLike) -> list[float | None]:
    """To be drawn, so six digits are enough."""
    return [
        None if not np.isfinite(one) else float(f"{one:.{_DIGITS}g}")
        for one in np.asarray(values, float).tolist()
    ]
