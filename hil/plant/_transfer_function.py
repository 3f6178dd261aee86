"""Exact replay of transfer-function models: held input, dead time that need not be a whole sample."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.model import TransferFunction
from hil.core.runtime.compiled import compiled

Array = npt.NDArray[np.float64]

_SLOW_S = 1.0  # a mode that decays over more than this is the axle's motion as a whole


def respond(function: TransferFunction, torque: Array, dt: float, start: float) -> Array:
    """Output at each sample for `torque` held `dt` seconds, starting from the steady output `start`.

    What holds an output without input is the slowest mode: `start` goes to it, a free integrator or the pole
    of an axle that coasts down. A function without a slow mode starts where the torque before held it.
    """
    from scipy.signal import tf2ss  # slow to import, and seldom needed

    numerator, denominator = _proper(function)
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
    x = start * _at_rest(a, b, c) if start else np.zeros(n)
    return np.asarray(_filter(transition, of_old, of_new, c[0], float(d[0, 0]), torque, whole, x))


def _proper(function: TransferFunction) -> tuple[Array, Array]:
    """Numerator and denominator without leading zeros and without common factors s."""
    denominator = np.trim_zeros(np.asarray(function.denominator), "f")
    numerator = np.trim_zeros(np.asarray(function.numerator), "f")
    while len(numerator) > 1 and numerator[-1] == 0.0 == denominator[-1]:
        numerator, denominator = numerator[:-1], denominator[:-1]
    return numerator, denominator


def _at_rest(a: Array, b: Array, c: Array) -> Array:
    """The state that shows an output of 1 and stays there longest."""
    poles, modes = np.linalg.eig(a)
    slowest = int(np.argmin(np.abs(poles)))
    if abs(poles[slowest].imag) == 0.0 and abs(poles[slowest]) * _SLOW_S < 1.0:
        mode = modes[:, slowest].real
    else:
        mode = np.linalg.solve(a, b)[:, 0]
    reach = float((c @ mode)[0])
    return np.asarray(mode / reach) if reach else np.zeros(len(a))


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
    x, moved = x.copy(), np.empty(n)
    for k in range(torque.shape[0]):
        new = torque[max(k - whole, 0)] if k >= whole else 0.0
        old = torque[max(k - whole - 1, 0)] if k >= whole + 1 else 0.0
        y[k] = d * old
        for i in range(n):
            y[k] += c[i] * x[i]
        for i in range(n):
            moved[i] = of_old[i] * old + of_new[i] * new
            for j in range(n):
                moved[i] += transition[i, j] * x[j]
        x, moved = moved, x
    return y
