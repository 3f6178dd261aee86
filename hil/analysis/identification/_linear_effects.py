"""Transfer functions of a chain together with those of its effects that act linearly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigvals

from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model, TransferFunction
from hil.plant import linear_system

Array = npt.NDArray[np.float64]

_TORQUE = 0
_INTEGRATOR = 1e-9  # of the fastest pole: slower is none, but rounding of an integrator


def linear_effects(model: Model) -> tuple[EffectUse, ...]:
    """The effects of a chain that change its linear part: lag, dead time, drag, tyre, mounts."""
    whole = linear_system(model)
    found = []
    for index, use in enumerate(model.effects):
        others = (*model.effects[:index], *model.effects[index + 1 :])
        less = linear_system(replace(model, effects=others))
        same = all(np.array_equal(getattr(whole, name), getattr(less, name)) for name in "abcd")
        if not same or whole.delay_s != less.delay_s:
            found.append(use)
    return tuple(found)


def functions_of_states(model: Model) -> dict[str, TransferFunction]:
    """From motor torque to each output, by poles, zeros and the first Markov parameter that is not zero."""
    system = linear_system(model)
    kept = _between(system.a, system.b[:, _TORQUE], system.c)
    a, b = system.a[np.ix_(kept, kept)], system.b[kept, _TORQUE]
    poles = _settled(np.asarray(np.linalg.eigvals(a), complex), a)
    denominator = tuple(float(c) for c in np.real(np.poly(poles)))
    functions = {}
    for row, name in enumerate(OUTPUTS):
        numerator = _numerator(a, b, system.c[row, kept], float(system.d[row, _TORQUE]))
        functions[name] = TransferFunction(numerator, denominator, system.delay_s)
    return functions


def _between(a: Array, b: Array, c: Array) -> npt.NDArray[np.bool_]:
    """States that the torque reaches and an output shows; the others are of effects that are not there."""
    links = a != 0.0
    reached, shown = b != 0.0, np.any(c != 0.0, axis=0)
    for _ in range(len(a)):
        reached = reached | np.any(links[:, reached], axis=1)
        shown = shown | np.any(links[shown], axis=0)
    return np.asarray(reached & shown)


def _settled(roots: npt.NDArray[np.complex128], a: Array) -> npt.NDArray[np.complex128]:
    """Roots at the origin exactly there."""
    fastest = float(np.max(np.abs(np.linalg.eigvals(a))))
    return np.where(np.abs(roots) < _INTEGRATOR * fastest, 0.0, roots)


def _numerator(a: Array, b: Array, c: Array, d: float) -> tuple[float, ...]:
    order, first, power = len(a), d, b
    degree = 0  # of the denominator over the numerator
    while first == 0.0 and degree < order:
        first, power, degree = float(c @ power), a @ power, degree + 1
    if first == 0.0:
        return (0.0,)
    # the zeros: frequencies at which states move and the output does not
    pencil = np.block([[a, b[:, None]], [c[None, :], np.array([[d]])]])
    mass = np.zeros_like(pencil)
    mass[:order, :order] = np.eye(order)
    found = eigvals(pencil, mass)
    finite = sorted(found[np.isfinite(found)], key=abs)[: order - degree]
    zeros = _settled(np.array(finite, dtype=complex), a)
    return tuple(float(k) for k in first * np.real(np.poly(zeros)))
