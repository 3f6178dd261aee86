"""How hot functions are compiled: cached, IEEE division, contraction allowed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

_F = TypeVar("_F", bound=Callable[..., object])
# No 'nnan' or 'ninf': limits that are off are infinite, and a diverged simulation must show as NaN.
_FAST = {"contract", "arcp", "reassoc", "nsz"}


def compiled(function: _F) -> Any:
    """Compile `function` with numba."""
    return njit(cache=True, error_model="numpy", fastmath=_FAST)(function)


def inlined(function: _F) -> Any:
    """Compile `function` into each of its callers."""
    return njit(cache=True, error_model="numpy", fastmath=_FAST, inline="always")(function)


def compiled_parallel(function: _F) -> Any:
    """Compile `function` with its prange loops spread over threads."""
    return njit(cache=True, error_model="numpy", fastmath=_FAST, parallel=True)(function)
