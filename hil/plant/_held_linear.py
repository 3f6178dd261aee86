"""The linear part of a driveline over one held step, as matrices: what makes many replays affordable.

Without nonlinear forces a held input moves the state exactly by a matrix product. Nonlinear forces are
split off as three inputs that vary linearly over a step (exponential time differencing, order two):
x' = A·x + B·[torque, extra shaft torque, extra rotor loss, load on the vehicle].
Source: S. M. Cox, P. C. Matthews, J. Comput. Phys. 176 (2002) 430-455.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.compiled import compiled
from hil.plant import _slots as P
from hil.plant import _states as X

Array = npt.NDArray[np.float64]

# Inputs
TORQUE, SHAFT, LOSS, LOAD = range(4)
INPUTS = 4
_TERMS = 18  # of the series: at a norm of 0.5 the rest is below 1e-17, whatever the units


def system(p: Array) -> tuple[Array, Array]:
    """A (8 x 8) and B (8 x 4) of the linear part of a packed model, SI units."""
    a, b = np.zeros((X.LINEAR_STATES, X.LINEAR_STATES)), np.zeros((X.LINEAR_STATES, INPUTS))
    if p[P.KIND] == P.RIGID:
        _rigid(p, a, b)
    else:
        _chain(p, a, b)
    if p[P.LAG] > 0.0:
        a[:, X.LAGGED] += b[:, TORQUE]
        b[:, TORQUE] = 0.0
        a[X.LAGGED, :] = 0.0
        a[X.LAGGED, X.LAGGED], b[X.LAGGED, TORQUE] = -1.0 / p[P.LAG], 1.0 / p[P.LAG]
    return a, b


def _rigid(p: Array, a: Array, b: Array) -> None:
    n = p[P.GEAR_RATIO]
    inertia = p[P.MOTOR_INERTIA] + p[P.VEHICLE_INERTIA] / n**2
    for state, share in ((X.ROTOR_SPEED, 1.0), (X.WHEEL_SPEED, 1.0 / n), (X.VEHICLE_SPEED, 1.0 / n)):
        a[state, X.ROTOR_SPEED] = -share * p[P.DRAG] / inertia
        b[state] = np.array([share, 0.0, -share, -share / n]) / inertia


def _chain(p: Array, a: Array, b: Array) -> None:
    n = p[P.GEAR_RATIO]
    slope = np.zeros(X.LINEAR_STATES)  # of the twist
    slope[X.ROTOR_SPEED], slope[X.HOUSING_SPEED], slope[X.WHEEL_SPEED] = 1.0 / n, 1.0 - 1.0 / n, -1.0
    shaft = p[P.SHAFT_DAMPING] * slope
    shaft[X.TWIST] += p[P.SHAFT_STIFFNESS]
    loss = np.zeros(X.LINEAR_STATES)
    loss[X.ROTOR_SPEED], loss[X.HOUSING_SPEED] = p[P.DRAG], -p[P.DRAG]
    a[X.TWIST] = slope
    a[X.ROTOR_SPEED] = (-loss - shaft / n) / p[P.MOTOR_INERTIA]
    b[X.ROTOR_SPEED] = np.array([1.0, -1.0 / n, -1.0, 0.0]) / p[P.MOTOR_INERTIA]
    if p[P.HOUSING_INERTIA] > 0.0:
        a[X.HOUSING_ANGLE, X.HOUSING_SPEED] = 1.0
        a[X.HOUSING_SPEED] = (loss - (1.0 - 1.0 / n) * shaft) / p[P.HOUSING_INERTIA]
        a[X.HOUSING_SPEED, X.HOUSING_ANGLE] -= p[P.MOUNT_STIFFNESS] / p[P.HOUSING_INERTIA]
        a[X.HOUSING_SPEED, X.HOUSING_SPEED] -= p[P.MOUNT_DAMPING] / p[P.HOUSING_INERTIA]
        b[X.HOUSING_SPEED] = np.array([-1.0, 1.0 / n - 1.0, 1.0, 0.0]) / p[P.HOUSING_INERTIA]
    if p[P.KIND] == P.TWO_INERTIA:
        a[X.WHEEL_SPEED] = a[X.VEHICLE_SPEED] = shaft / p[P.VEHICLE_INERTIA]
        b[X.WHEEL_SPEED] = b[X.VEHICLE_SPEED] = np.array([0.0, 1.0, 0.0, -1.0]) / p[P.VEHICLE_INERTIA]
        return
    road = np.zeros(X.LINEAR_STATES)
    road[X.TYRE_TWIST] = p[P.TYRE_STIFFNESS]
    road[X.WHEEL_SPEED], road[X.VEHICLE_SPEED] = p[P.TYRE_DAMPING], -p[P.TYRE_DAMPING]
    a[X.WHEEL_SPEED] = (shaft - road) / p[P.WHEEL_INERTIA]
    b[X.WHEEL_SPEED] = np.array([0.0, 1.0, 0.0, 0.0]) / p[P.WHEEL_INERTIA]
    a[X.TYRE_TWIST, X.WHEEL_SPEED], a[X.TYRE_TWIST, X.VEHICLE_SPEED] = 1.0, -1.0
    a[X.VEHICLE_SPEED] = road / p[P.VEHICLE_INERTIA]
    b[X.VEHICLE_SPEED] = np.array([0.0, 0.0, 0.0, -1.0]) / p[P.VEHICLE_INERTIA]


@compiled
def _product(a, b):  # type: ignore[no-untyped-def]
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            for j in range(b.shape[1]):
                out[i, j] += a[i, k] * b[k, j]
    return out


@compiled
def held_step(a, b, duration):  # type: ignore[no-untyped-def]
    """Transition over `duration`, effect of inputs held, and of inputs that rise from 0 to 1 over it.

    A Taylor series over a small part of the duration, doubled until it is whole. Written out, because a
    linear algebra library's threads cost many times what products of matrices this small do.
    Source: N. J. Higham, Functions of Matrices, SIAM 2008, ch. 10.
    """
    square = _product(a, a)
    # of the fourth power, since a itself mixes units: its norm says little about how large a power gets
    norm = duration * np.abs(_product(square, square)).sum(axis=0).max() ** 0.25
    part, doublings = duration, 0
    while 0.5 < norm < math.inf:
        part, norm, doublings = 0.5 * part, 0.5 * norm, doublings + 1
    one, z = np.eye(X.LINEAR_STATES), part * a
    # exp(z), phi_1 = (exp(z) - 1)/z and phi_2 = (phi_1 - 1)/z
    phi_2 = one.copy()
    for k in range(_TERMS, 2, -1):
        phi_2 = one + _product(z, phi_2) / k
    phi_2 *= 0.5
    phi_1 = one + _product(z, phi_2)
    power = one + _product(z, phi_1)
    for _ in range(doublings):
        phi_2 = 0.25 * (_product(power, phi_2) + phi_1 + phi_2)
        phi_1 = 0.5 * (_product(power, phi_1) + phi_1)
        power = _product(power, power)
    return power, duration * _product(phi_1, b), duration * _product(phi_2, b)


def step_matrices(p: Array, dt: float, substeps: int) -> tuple[Array, Array, Array, Array]:
    """What the compiled loop needs of one packed model.

    Returns:
        transition (8 x 8, transposed), torque columns (substeps x 2 x 8: effect of the older and the newer
        torque in each substep, the switch laid exactly), held forces (3 x 8), rising forces (3 x 8).
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
