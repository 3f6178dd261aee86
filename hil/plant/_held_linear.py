"""The linear part of a driveline over one held step, as matrices: what makes many replays affordable.

Without nonlinear forces a held input moves the state exactly by a matrix product. Nonlinear forces are
split off as inputs that vary linearly over a step (exponential time differencing, order two):
x' = A·x + B·[torque, the inputs behind it in `_linear`].
Source: S. M. Cox, P. C. Matthews, J. Comput. Phys. 176 (2002) 430-455.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._linear import SHAFT, TORQUE, system

Array = npt.NDArray[np.float64]

_TERMS = 18  # of the series: at a norm of 0.5 the rest is below 1e-17, whatever the units


@compiled
def _product(a, b):  # type: ignore[no-untyped-def]
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            for j in range(b.shape[1]):
                out[i, j] += a[i, k] * b[k, j]
    return out


@compiled
def _added(a, factor, b):  # type: ignore[no-untyped-def]
    """factor·(a + b): a loop, because an expression of arrays takes a second to compile."""
    out = np.empty(a.shape)
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            out[i, j] = factor * (a[i, j] + b[i, j])
    return out


@compiled
def _scaled(a, factor, diagonal):  # type: ignore[no-untyped-def]
    """factor·a with `diagonal` added to its diagonal."""
    out = np.empty(a.shape)
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            out[i, j] = factor * a[i, j] + (diagonal if i == j else 0.0)
    return out


@compiled
def _largest_column(a):  # type: ignore[no-untyped-def]
    """The 1-norm of a matrix."""
    largest = 0.0
    for j in range(a.shape[1]):
        total = 0.0
        for i in range(a.shape[0]):
            total += abs(a[i, j])
        if not total <= largest:  # NaN too
            largest = total
    return largest


@compiled
def held_step(a, b, duration):  # type: ignore[no-untyped-def]
    """Transition over `duration`, effect of inputs held, and of inputs that rise from 0 to 1 over it.

    A Taylor series over a small part of the duration, doubled until it is whole. Written out, because a
    linear algebra library's threads cost many times what products of matrices this small do.
    Source: N. J. Higham, Functions of Matrices, SIAM 2008, ch. 10.
    """
    square = _product(a, a)
    # of the fourth power, since a itself mixes units: its norm says little about how large a power gets
    norm = duration * _largest_column(_product(square, square)) ** 0.25
    part, doublings = duration, 0
    while 0.5 < norm < math.inf:
        part, norm, doublings = 0.5 * part, 0.5 * norm, doublings + 1
    z = _scaled(a, part, 0.0)
    # exp(z), phi_1 = (exp(z) - 1)/z and phi_2 = (phi_1 - 1)/z
    phi_2 = _scaled(a, 0.0, 1.0)
    for k in range(_TERMS, 2, -1):
        phi_2 = _scaled(_product(z, phi_2), 1.0 / k, 1.0)
    phi_2 = _scaled(phi_2, 0.5, 0.0)
    phi_1 = _scaled(_product(z, phi_2), 1.0, 1.0)
    power = _scaled(_product(z, phi_1), 1.0, 1.0)
    for _ in range(doublings):
        phi_2 = _added(_product(power, phi_2), 0.25, _added(phi_1, 1.0, phi_2))
        phi_1 = _added(_product(power, phi_1), 0.5, phi_1)
        power = _product(power, power)
    return power, _scaled(_product(phi_1, b), duration, 0.0), _scaled(_product(phi_2, b), duration, 0.0)


def step_matrices(p: Array, dt: float, substeps: int) -> tuple[Array, Array, Array, Array]:
    """What the compiled loop needs of one packed model.

    Returns:
        transition (8 x 8, transposed), torque columns (substeps x 2 x 8: effect of the older and the newer
        torque in each substep, the switch laid exactly), held forces (5 x 8), rising forces (5 x 8).
    """
    a, b = system(p)
    h = dt / substeps
    transition, held, rising = held_step(a, b, h)
    late = p[P.TORQUE_DELAY] - np.floor(p[P.TORQUE_DELAY] / dt + 1e-9) * dt
    torque = np.zeros((substeps, 2, X.LINEAR_STATES))
    for index in range(substeps):
        before = float(np.clip(late - index * h, 0.0, h))
        if before >= h - 1e-12:
            torque[index, 0] = held[:, TORQUE]
        elif before <= 1e-12:
            torque[index, 1] = held[:, TORQUE]
        else:
            rest, new, _ = held_step(a, b, h - before)
            torque[index, 0] = rest @ held_step(a, b, before)[1][:, TORQUE]
            torque[index, 1] = new[:, TORQUE]
    return transition.T.copy(), torque, held[:, SHAFT:].T.copy(), rising[:, SHAFT:].T.copy()
