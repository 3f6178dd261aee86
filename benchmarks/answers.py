"""Answers of programs that are compared: a time is a figure only where both computed the same.

A benchmark that compares calls `largest_difference` before it prints a ratio; it raises where an answer is
not a number, has another shape, or differs by more than is allowed, and the benchmark ends with that error.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


class OtherAnswerError(Exception):
    """A compared program computed something else: its time says nothing."""


def refuse_no_numbers(what: str, values: npt.ArrayLike) -> None:
    """Refuse an answer that is not made of finite numbers.

    Raises:
        OtherAnswerError: it is not.
    """
    numbers = np.asarray(values, float)
    bad = numbers.size - np.count_nonzero(np.isfinite(numbers))
    if bad:
        raise OtherAnswerError(f"{what}: {bad} of {numbers.size} values are no finite numbers")


def largest_difference(
    what: str, ours: npt.ArrayLike, others: npt.ArrayLike, allowed: float, *, relative: bool = False
) -> float:
    """The largest difference of two answers, in their unit; `relative`: as a share of the larger value.

    Args:
        what: the compared program, for the error.
        allowed: the largest difference at which both computed the same.

    Raises:
        OtherAnswerError: they did not.
    """
    one, other = np.asarray(ours, float), np.asarray(others, float)
    if one.shape != other.shape:
        raise OtherAnswerError(f"{what}: {other.shape} values where {one.shape} were computed here")
    refuse_no_numbers("this program", one)
    refuse_no_numbers(what, other)
    differences = np.abs(one - other)
    if relative:
        differences = differences / np.maximum(np.maximum(np.abs(one), np.abs(other)), 1e-300)
    largest = float(np.max(differences, initial=0.0))
    if largest > allowed:
        raise OtherAnswerError(f"{what}: its answer differs by up to {largest:.3g}, {allowed:.3g} is allowed")
    return largest
