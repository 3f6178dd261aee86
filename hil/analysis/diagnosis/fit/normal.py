"""Normal equations of least squares over recordings that share all numbers but their initial values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Normal:
    """Normal equations of one recording: of the shared coordinates, of its start, and between them."""

    shared: Array
    between: Array
    start: Array
    shared_gradient: Array
    start_gradient: Array

    @cached_property
    def start_inverse(self) -> Array:
        """Pseudo-inverse of `start`: what a recording does not tell of its initial values stays."""
        return np.asarray(np.linalg.pinv(self.start, rcond=1e-10, hermitian=True))


def normal_equations(shared: Array, initial: Array, error: Array) -> Normal:
    """Products of derivatives and errors."""
    return Normal(
        shared.T @ shared, shared.T @ initial, initial.T @ initial, shared.T @ error, initial.T @ error
    )


def reduced(normals: Sequence[Normal]) -> tuple[Array, Array]:
    """Normal equations with every recording's start eliminated."""
    size = len(normals[0].shared_gradient)
    matrix, gradient = np.zeros((size, size)), np.zeros(size)
    for n in normals:
        matrix += n.shared - n.between @ n.start_inverse @ n.between.T
        gradient += n.shared_gradient - n.between @ (n.start_inverse @ n.start_gradient)
    return matrix, gradient


def start_step(n: Normal, step: Array) -> Array:
    """The best change of a recording's start when the shared coordinates change by `step`."""
    return np.asarray(n.start_inverse @ (n.start_gradient - n.between.T @ step))


def promised_gain(normals: Sequence[Normal], matrix: Array, gradient: Array, step: Array) -> float:
    """What a step of the shared coordinates, with the starts that suit it, takes off the squared errors.

    `matrix` and `gradient` are the reduced ones, with what is known beforehand; derivatives stay as they are.
    """
    of_starts = sum(float(n.start_gradient @ n.start_inverse @ n.start_gradient) for n in normals)
    return float(2.0 * gradient @ step - step @ matrix @ step) + of_starts
