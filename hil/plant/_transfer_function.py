"""Exact replay of transfer-function models: held input, dead time that need not be a whole sample."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.compiled import compiled
from hil.core.model import TransferFunction

Array = npt.NDArray[np.float64]


def respond(function: TransferFunction, torque: Array, dt: float, start: float) -> Array:
    """Output at each sample for `torque` held `dt` seconds, starting from the steady output `start`.

    Only a free integrator can hold an output without input: `start` goes to it where there is one.
    """
    from scipy.signal import tf2ss  # slow to import, and seldom needed

    denominator = np.trim_zeros(np.asarray(function.denominator), "f")
    numerator = np.trim_zeros(np.asarray(function.numerator), "f")
    while len(numerator) > 1 and numerator[-1] == 0.0 == denominator[-1]:
        numerator, denominator = numerator[:-1], denominator[:-1]
    if len(denominator) == 1:
        return np.asarray(start + np.zeros_like(torque) + (numerator[-1] / denominator[-1]) * torque)
    a, b, c, d = (np.atleast_2d(m) for m in tf2ss(numerator, denominator))
    whole = math.floor(function.delay_s / dt + 1e-9)
    late = max(0.0, function.delay_s - whole * dt)
    step_old, step_new = _held(a, b, late), _held(a, b, dt - late)
    n = len(a)
    transition = step_new[:n, :n] @ step_old[:n, :n]
    of_old = step_new[:n, :n] @ step_old[:n, n]
    of_new = step_new[:n, n]
    x = np.zeros(n)
    if denominator[-1] == 0.0 and start != 0.0:
        rest = np.linalg.svd(a)[2][-1]  # the direction that A leaves at rest
        reach = float((c @ rest)[0])
        x = rest * (start / reach) if reach else x
    return np.asarray(_filter(transition, of_old, of_new, c[0], float(d[0, 0]), torque, whole, x))


def _held(a: Array, b: Array, duration: float) -> Array:
    """exp([[A, B], [0, 0]]·duration): state transition and effect of a held input."""
    from scipy.linalg import expm  # slow to import, and seldom needed

    n = len(a)
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n:] = a, b
    return np.asarray(expm(block * duration))


@compiled
def _filter(transition, of_old, of_new, c, d, torque, whole, x):  # type: ignore[no-untyped-def]
    y = np.empty(torque.shape[0])
    n = x.shape[0]
    for k in range(torque.shape[0]):
        new = torque[max(k - whole, 0)] if k >= whole else 0.0
        old = torque[max(k - whole - 1, 0)] if k >= whole + 1 else 0.0
        y[k] = d * old
        for i in range(n):
            y[k] += c[i] * x[i]
        moved = np.empty(n)
        for i in range(n):
            moved[i] = of_old[i] * old + of_new[i] * new
            for j in range(n):
                moved[i] += transition[i, j] * x[j]
        x = moved
    return y
