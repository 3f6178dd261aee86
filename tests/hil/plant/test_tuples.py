"""Arithmetic on tuples in compiled code rounds as scalars do, whatever the length."""

from typing import Any

import numpy as np
import pytest
from numba import njit
from numba.np.unsafe.ndarray import to_fixed_tuple

from hil.plant._tuples import plus, plus_product, plus_row


def _compiled(width: int) -> tuple[Any, Any, Any]:
    @njit
    def sums(x, factor, y):  # type: ignore[no-untyped-def]
        return plus(to_fixed_tuple(x, width), factor, to_fixed_tuple(y, width))

    @njit
    def rows(x, factor, matrix, row):  # type: ignore[no-untyped-def]
        return plus_row(to_fixed_tuple(x, width), factor, matrix, row)

    @njit
    def products(x, y, matrix):  # type: ignore[no-untyped-def]
        return plus_product(to_fixed_tuple(x, width), to_fixed_tuple(y, width), matrix)

    return sums, rows, products


@pytest.mark.parametrize("width", [3, 8, 9])
def test_sums_are_those_of_scalars_to_the_last_bit(width: int) -> None:
    sums, rows, products = _compiled(width)
    rng = np.random.default_rng(width)
    x, y, matrix = rng.normal(size=width), rng.normal(size=width), rng.normal(size=(width, width))
    assert sums(x, 0.3, y) == tuple(x + 0.3 * y)
    assert rows(x, 0.3, matrix, width - 1) == tuple(x + 0.3 * matrix[-1])
    parts = [factor * row for factor, row in zip(y, matrix, strict=True)]
    while len(parts) > 1:
        odd = parts[len(parts) - len(parts) % 2 :]
        parts = [one + other for one, other in zip(parts[::2], parts[1::2], strict=False)] + odd
    assert products(x, y, matrix) == tuple(x + parts[0])
