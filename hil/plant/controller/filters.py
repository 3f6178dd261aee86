"""Linear filters as the RMCU runs them: Tustin at the controller rate, transposed direct form II."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled

Array = npt.NDArray[np.float64]
LARGEST_ORDER = 8


@dataclass(frozen=True)
class Filter:
    """Discrete filter; `numerator` and `denominator` have LARGEST_ORDER + 1 entries, a_0 = 1."""

    numerator: Array
    denominator: Array


def discretised(
    numerator: npt.ArrayLike, denominator: npt.ArrayLike, sample_time_s: float
) -> tuple[Array, Array]:
    """Coefficients b, a (ascending powers of z⁻¹, a[0] = 1) of a function (descending powers of s).

    By Tustin's rule, s = (2/T)(1 - z⁻¹)/(1 + z⁻¹), without prewarping. Roots at s = 0 that stand above and
    below are cancelled first.

    Raises:
        ValueError: improper, without a denominator, or of too high an order for the RMCU.
    """
    above = np.trim_zeros(np.atleast_1d(np.asarray(numerator, dtype=float)), "f")
    below = np.trim_zeros(np.atleast_1d(np.asarray(denominator, dtype=float)), "f")
    while len(above) > 1 and len(below) > 1 and above[-1] == 0.0 and below[-1] == 0.0:
        above, below = above[:-1], below[:-1]
    if len(below) == 0 or len(above) > len(below):
        raise ValueError(
            f"an improper filter, of order {len(above) - 1} over {len(below) - 1}, cannot be run"
        )
    if len(below) > LARGEST_ORDER + 1:
        raise ValueError(f"a filter of order {len(below) - 1} cannot be run, only up to {LARGEST_ORDER}")
    b, a = (_bilinear(part, len(below) - 1, sample_time_s) for part in (above, below))
    return b / a[0], a / a[0]


def _bilinear(polynomial: Array, order: int, sample_time_s: float) -> Array:
    """Coefficients in z⁻¹ of a polynomial in s times (z + 1)^order, the factor 2/T shared by both.

    `scipy.signal.bilinear` does the same; scipy.signal takes longer to import than a plan to be predicted.
    """
    share = np.sqrt(2.0 / sample_time_s)
    plus, minus = _powers(np.array([1.0, 1.0]) / share, order), _powers(np.array([-1.0, 1.0]) * share, order)
    total = np.zeros(order + 1)  # ascending powers of z
    for n, coefficient in enumerate(polynomial[::-1]):
        total += np.convolve(coefficient * plus[order - n], minus[n])
    return total[::-1]


def _powers(base: Array, most: int) -> list[Array]:
    """A polynomial to the powers 0 to `most`."""
    found = [np.ones(1)]
    for _ in range(most):
        found.append(np.convolve(found[-1], base))
    return found


def tustin(numerator: npt.ArrayLike, denominator: npt.ArrayLike, sample_time_s: float) -> Filter:
    """The filter that the RMCU runs for numerator/denominator (descending powers of s), by `discretised`.

    Raises:
        ValueError: improper, of too high an order, or unstable.
    """
    b, a = discretised(numerator, denominator, sample_time_s)
    if len(a) > 1 and np.max(np.roots(np.atleast_1d(denominator)).real) > 1e-9:
        raise ValueError("the filter is unstable")
    padded = np.zeros((2, LARGEST_ORDER + 1))
    padded[0, : len(b)], padded[1, : len(a)] = b, a
    return Filter(padded[0], padded[1])


@compiled
def step(b, a, z, u):  # type: ignore[no-untyped-def]
    """One sample: output for input `u`; the state `z` moves."""
    y = b[0] * u + z[0]
    for i in range(LARGEST_ORDER - 1):
        z[i] = b[i + 1] * u + z[i + 1] - a[i + 1] * y
    z[LARGEST_ORDER - 1] = b[LARGEST_ORDER] * u - a[LARGEST_ORDER] * y
    return y


@compiled
def settle(b, a, z, u):  # type: ignore[no-untyped-def]
    """Set the state as if the input had been `u` for ever."""
    above = 0.0
    below = 0.0
    for i in range(LARGEST_ORDER + 1):
        above += b[i]
        below += a[i]
    y = u * above / below if below != 0.0 else 0.0
    for i in range(LARGEST_ORDER - 1, -1, -1):
        later = z[i + 1] if i + 1 < LARGEST_ORDER else 0.0
        z[i] = later + b[i + 1] * u - a[i + 1] * y
