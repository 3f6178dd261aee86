"""Driveline chains in closed form: rotor, gear, shafts, what hangs on them, and effects that act linearly.

Driveline chains in closed form: rotor, gear, shafts, what hangs on them, and effects that act linearly.

Equations of motion, wheel side except the rotor (N gear ratio, T the torque after the dead time):

    J_m dω_m/dt = T - drag·ω_m - T_s/N                              rotor
    dT_s/dt = k (ω_m/N - ω_l) + d d(ω_m/N - ω_l)/dt                  shafts
    J_w dω_l/dt = T_s - T_t                                          wheel and dyno rotor
    dT_t/dt = k_t (ω_l - ω_v) + d_t d(ω_l - ω_v)/dt                  tyre and road
    J_v dω_v/dt = T_t                                                vehicle

`two_inertia` has no wheel and tyre: J_v dω_l/dt = T_s. `rigid` has no shafts either: ω_l = ω_m/N and
T_s = J_v dω_l/dt is the torque that the load needs; only it has drag.

With C = d s + k and T_s/ω_l = s P/Q (P = J_v, Q = 1 for two inertias; P = J_w(J_v s² + D) + J_v D,
Q = J_v s² + D, D = d_t s + k_t for three), M = s²P + CQ and Δ = s (J_m M + C P/N²):

    ω_m/T = M/Δ,   ω_l/T = C Q/(N Δ),   T_s/T = s C P/(N Δ)

For three inertias the orders are 4, 3, 4 over 5, as in the paper's (14)-(16).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigvals

from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
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


ComplexArray = npt.NDArray[np.complex128]

CHAINS = ("rigid", "two_inertia", "three_inertia")


def chain_polynomials(kind: str, parameters: Mapping[str, float]) -> tuple[dict[str, Array], Array]:
    """Numerators by output and their denominator, descending powers of s, without the dead time.

    The pole at the origin is an exact 0 at the end of the denominator (without drag), and the zero of
    T_s that cancels it an exact 0 at the end of its numerator.
    """
    rotor, ratio = parameters["motor_inertia"], parameters["gear_ratio"]
    load = parameters["vehicle_inertia"]
    if kind == "rigid":
        drag = parameters["viscous_drag"]
        denominator = np.array([rotor + load / ratio**2, drag])
        numerators = (np.array([1.0]), np.array([1 / ratio]), np.array([load / ratio, 0.0]))
        return dict(zip(OUTPUTS, numerators, strict=True)), denominator
    shaft = np.array([parameters["shaft_damping"], parameters["shaft_stiffness"]])
    p, q = np.array([load]), np.array([1.0])
    if kind == "three_inertia":
        tyre = np.array([parameters["tyre_damping"], parameters["tyre_stiffness"]])
        q = np.polyadd([load, 0.0, 0.0], tyre)
        p = np.polyadd(parameters["wheel_inertia"] * q, load * tyre)
    m = np.polyadd(np.concatenate([p, [0.0, 0.0]]), np.polymul(shaft, q))
    free = np.polyadd(rotor * m, np.polymul(shaft, p) / ratio**2)
    numerators = (m, np.polymul(shaft, q) / ratio, np.append(np.polymul(shaft, p) / ratio, 0.0))
    trimmed = [np.trim_zeros(numerator, "f") for numerator in numerators]
    return dict(zip(OUTPUTS, trimmed, strict=True)), np.append(free, 0.0)


def chain_response(kind: str, parameters: Mapping[str, float], frequency_hz: Array) -> ComplexArray:
    """Responses (3 x F, in the order of `OUTPUTS`) of a chain, dead time included."""
    s = 2j * np.pi * np.asarray(frequency_hz, dtype=float)
    rotor, ratio, load = (parameters[k] for k in ("motor_inertia", "gear_ratio", "vehicle_inertia"))
    delay = np.exp(-parameters["torque_delay"] * s)
    if kind == "rigid":
        speed = delay / ((rotor + load / ratio**2) * s + parameters["viscous_drag"])
        return np.stack([speed, speed / ratio, load * s * speed / ratio])
    shaft = parameters["shaft_damping"] * s + parameters["shaft_stiffness"]
    p: ComplexArray | float = load
    q: ComplexArray | float = 1.0
    if kind == "three_inertia":
        tyre = parameters["tyre_damping"] * s + parameters["tyre_stiffness"]
        q = load * s * s + tyre
        p = parameters["wheel_inertia"] * q + load * tyre
    m = s * s * p + shaft * q
    common = delay / (s * (rotor * m + shaft * p / ratio**2))
    return np.stack([m * common, shaft * q / ratio * common, s * shaft * p / ratio * common])


def transfer_functions_of(model: Model) -> tuple[dict[str, TransferFunction], tuple[str, ...]]:
    """Transfer functions of any model, and notes on what they leave out.

    A chain is converted by the formulas above, with effects that act linearly by its states; the others are
    nonlinear, or faults of sensors and disturbances, and are left out, with a note.

    Raises:
        BadInputError: the functions do not share one denominator and one dead time.
    """
    linear: tuple[EffectUse, ...] = () if model.kind == "transfer_function" else linear_effects(model)
    left_out = [use.id for use in model.effects if use not in linear]
    notes: tuple[str, ...] = ()
    if left_out:
        notes = (f"effects of the model are left out of the linear design: {', '.join(left_out)}",)
    if model.kind == "transfer_function":
        return _with_one_denominator(model.transfer_functions), notes
    if linear:
        return functions_of_states(replace(model, effects=linear)), notes
    numerators, denominator = chain_polynomials(model.kind, model.parameters)
    lead = denominator[0]
    delay = model.parameters["torque_delay"]
    functions = {
        name: TransferFunction(
            tuple(float(c) for c in numerator / lead), tuple(float(c) for c in denominator / lead), delay
        )
        for name, numerator in numerators.items()
    }
    return functions, notes


def _with_one_denominator(given: Mapping[str, TransferFunction]) -> dict[str, TransferFunction]:
    """The functions as they are; BadInputError if they do not share denominator and dead time."""
    functions = dict(given)
    first = next(iter(functions.values()))
    for name, function in functions.items():
        same = len(function.denominator) == len(first.denominator) and np.allclose(
            np.divide(function.denominator, function.denominator[0]),
            np.divide(first.denominator, first.denominator[0]),
            rtol=1e-9,
        )
        if not same or abs(function.delay_s - first.delay_s) > 1e-9:
            raise BadInputError(
                f"'{name}' has another denominator or dead time than the first output",
                fix="identify all outputs together: hil identify writes one common denominator",
            )
    return functions
