"""Arithmetic on tuples of floats in compiled code, whatever their length.

A state is a tuple, not an array: the compiler then keeps it in registers. numba has no arithmetic for tuples,
a loop over one is not always unrolled, and the compiler does not put scalars together to vectors: the sums
are written here as instructions on a processor's vectors. Each place is rounded as a scalar would be.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import intrinsic

#: `put(x, place, value)`: the tuple `x` with another value at one place.
put = tuple_setitem

_DOUBLE, _PLACE = ir.DoubleType(), ir.IntType(32)
_BYTES = 8  # what rows of an array are aligned to


def _vector(builder: Any, x: Any, width: int) -> Any:
    """A tuple as a vector: the compiler drops this and `_tuple` wherever one follows the other."""
    vector = ir.Constant(ir.VectorType(_DOUBLE, width), ir.Undefined)
    for i in range(width):
        vector = builder.insert_element(vector, builder.extract_value(x, i), _PLACE(i))
    return vector


def _tuple(builder: Any, vector: Any, like: Any, width: int) -> Any:
    for i in range(width):
        like = builder.insert_value(like, builder.extract_element(vector, _PLACE(i)), i)
    return like


def _everywhere(builder: Any, factor: Any, width: int) -> Any:
    """A vector with the same number at every place."""
    kind = ir.VectorType(_DOUBLE, width)
    one = builder.insert_element(ir.Constant(kind, ir.Undefined), factor, _PLACE(0))
    first = ir.Constant(ir.VectorType(_PLACE, width), [0] * width)
    return builder.shuffle_vector(one, ir.Constant(kind, ir.Undefined), first)


def _added(builder: Any, x: Any, factor: Any, values: Any, width: int) -> Any:
    return builder.fadd(x, builder.fmul(_everywhere(builder, factor, width), values))


def _row(context: Any, builder: Any, kind: Any, matrix: Any, row: Any, width: int) -> Any:
    data = context.make_array(kind)(context, builder, matrix).data
    first = builder.gep(data, [builder.mul(row, row.type(width))])
    return builder.load(builder.bitcast(first, ir.VectorType(_DOUBLE, width).as_pointer()), align=_BYTES)


@intrinsic
def plus(typing_context, x, factor, y):  # type: ignore[no-untyped-def]
    """x + factor·y of two tuples of the same length."""
    del typing_context, factor

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        del context
        first, scale, second = given
        width = signature.return_type.count
        vectors = _vector(builder, first, width), _vector(builder, second, width)
        return _tuple(builder, _added(builder, vectors[0], scale, vectors[1], width), first, width)

    return x(x, types.float64, y), code


@intrinsic
def plus_row(typing_context, x, factor, matrix, row):  # type: ignore[no-untyped-def]
    """x + factor·(a row of `matrix`, C-contiguous and as wide as the tuple is long; not checked)."""
    del typing_context, factor, row

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        first, scale, array, at = given
        width = signature.return_type.count
        values = _row(context, builder, signature.args[2], array, at, width)
        total = _added(builder, _vector(builder, first, width), scale, values, width)
        return _tuple(builder, total, first, width)

    return x(x, types.float64, matrix, types.intp), code


@intrinsic
def plus_product(typing_context, x, y, matrix):  # type: ignore[no-untyped-def]
    """x + y·matrix, C-contiguous, as wide as x is long and as high as y; not checked.

    Rows are summed in pairs, and x comes last: each sum waits for those before it.
    """
    del typing_context

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        first, factors, array = given
        width = signature.return_type.count
        parts = []
        for i in range(signature.args[1].count):
            at = context.get_constant(types.intp, i)
            values = _row(context, builder, signature.args[2], array, at, width)
            factor = builder.extract_value(factors, i)
            parts.append(builder.fmul(_everywhere(builder, factor, width), values))
        while len(parts) > 1:
            odd = parts[len(parts) - len(parts) % 2 :]
            parts = [builder.fadd(*pair) for pair in zip(parts[::2], parts[1::2], strict=False)] + odd
        total = builder.fadd(_vector(builder, first, width), parts[0])
        return _tuple(builder, total, first, width)

    return x(x, y, matrix), code
