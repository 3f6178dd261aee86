"""Arithmetic on tuples of floats in compiled code, whatever their length.

A state is a tuple, not an array: the compiler then keeps it in registers. numba has no arithmetic for tuples,
and a loop over one is not always unrolled, so that the sums are written here as instructions.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import intrinsic

#: `put(x, place, value)`: the tuple `x` with another value at one place.
put = tuple_setitem


def _added(builder: Any, x: Any, factor: Any, values: list[Any]) -> Any:
    for i, value in enumerate(values):
        total = builder.fadd(builder.extract_value(x, i), builder.fmul(factor, value))
        x = builder.insert_value(x, total, i)
    return x


def _row(context: Any, builder: Any, kind: Any, matrix: Any, row: Any, width: int) -> list[Any]:
    data = context.make_array(kind)(context, builder, matrix).data
    start = builder.mul(row, row.type(width))
    return [builder.load(builder.gep(data, [builder.add(start, row.type(i))])) for i in range(width)]


@intrinsic
def plus(typing_context, x, factor, y):  # type: ignore[no-untyped-def]
    """x + factor·y of two tuples of the same length."""
    del typing_context, factor

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        del context
        first, scale, second = given
        values = [builder.extract_value(second, i) for i in range(signature.return_type.count)]
        return _added(builder, first, scale, values)

    return x(x, types.float64, y), code


@intrinsic
def plus_row(typing_context, x, factor, matrix, row):  # type: ignore[no-untyped-def]
    """x + factor·(a row of `matrix`, C-contiguous and as wide as the tuple is long; not checked)."""
    del typing_context, factor, row

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        first, scale, array, at = given
        values = _row(context, builder, signature.args[2], array, at, signature.return_type.count)
        return _added(builder, first, scale, values)

    return x(x, types.float64, matrix, types.intp), code


@intrinsic
def plus_product(typing_context, x, y, matrix):  # type: ignore[no-untyped-def]
    """x + y·matrix, square, C-contiguous and as wide as the tuples are long; not checked."""
    del typing_context

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        total, factors, array = given
        width = signature.return_type.count
        for i in range(width):
            at = context.get_constant(types.intp, i)
            values = _row(context, builder, signature.args[2], array, at, width)
            total = _added(builder, total, builder.extract_value(factors, i), values)
        return total

    return x(x, y, matrix), code
