"""The driveline as a linear system, for all who need one: many replays, identification, design, orders.

x' = A·x + B·u, y = C·x + D·u. Nonlinear effects stand as inputs: what the shafts carry beside stiffness and
damping, what the rotor loses beside drag, what loads the vehicle. The dead time stands beside the matrices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.runtime.compiled import compiled, compiled_without_lock, inlined
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant.slots import Table

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

INPUTS = Table()
_input = INPUTS.place
TORQUE = _input("motor_torque_nm", "N m", "on the rotor, before the actuator's lag")
SHAFT = _input("extra_shaft_torque_nm", "N m", "beside stiffness and damping of the shafts, wheel side")
LOSS = _input("rotor_loss_nm", "N m", "against positive motion of rotor against housing")
LOAD = _input("vehicle_load_nm", "N m", "against positive motion of the vehicle")
TYRE = _input("extra_tyre_torque_nm", "N m", "beside stiffness and damping of the tyre, wheel side")
TYRE_RATE = _input("extra_tyre_rate_rad_s", "rad/s", "of the tyre's twist beside wheel less vehicle speed")

OUTPUTS = Table()
_output = OUTPUTS.place
MOTOR_SPEED = _output("motor_speed_rad_s", "rad/s", "rotor against housing")
WHEEL_SPEED = _output("wheel_speed_rad_s", "rad/s", "of the wheels")
SHAFT_TORQUE = _output("shaft_torque_nm", "N m", "of the shafts, wheel side")


@dataclass(frozen=True)
class LinearSystem:
    """Matrices in SI units with the names of their rows and columns; `delay_s` acts on the motor torque."""

    a: Array
    b: Array
    c: Array
    d: Array
    delay_s: float
    states: tuple[str, ...] = X.STATES.names[: X.LINEAR_STATES]
    inputs: tuple[str, ...] = INPUTS.names
    outputs: tuple[str, ...] = OUTPUTS.names

    def response(self, frequency_hz: Array, source: str = INPUTS.names[TORQUE]) -> ComplexArray:
        """Complex responses of the outputs to one input: outputs x frequencies, dead time included.

        Args:
            frequency_hz: above 0 where the system has a free integrator.
            source: name of the input.
        """
        column = self.inputs.index(source)
        s = 2j * np.pi * np.asarray(frequency_hz, dtype=float)
        found = np.empty((len(self.outputs), len(s)), dtype=complex)
        used = np.any(self.a != 0.0, axis=0) | np.any(self.c != 0.0, axis=0)
        used &= np.any(self.a != 0.0, axis=1) | np.any(self.b != 0.0, axis=1)
        a, b, c = self.a[used][:, used], self.b[used, column], np.ascontiguousarray(self.c[:, used])
        _respond(a, b, c, self.d[:, column].copy(), s, found)
        if column == TORQUE:
            found *= np.exp(-self.delay_s * s)
        return found


def linear_system(model: Model) -> LinearSystem:
    """The linear part of a model of a driveline, its linear effects included.

    Raises:
        BadInputError: a transfer-function model, which has no states; an effect stands twice.
    """
    if model.kind == "transfer_function":
        raise BadInputError(
            "a 'transfer_function' model has no states",
            fix="give a rigid, two_inertia or three_inertia model",
        )
    return linear_system_of(P.pack(model))


def linear_system_of(slots: Array) -> LinearSystem:
    """The linear part of a packed model."""
    a, b = system(slots)
    c = np.zeros((len(OUTPUTS), X.LINEAR_STATES))
    d = np.zeros((len(OUTPUTS), len(INPUTS)))
    c[MOTOR_SPEED, X.ROTOR_SPEED], c[MOTOR_SPEED, X.HOUSING_SPEED] = 1.0, -1.0
    c[WHEEL_SPEED, X.WHEEL_SPEED] = 1.0
    if slots[P.KIND] == P.RIGID:  # what the load needs
        c[SHAFT_TORQUE] = slots[P.VEHICLE_INERTIA] * a[X.VEHICLE_SPEED]
        d[SHAFT_TORQUE] = slots[P.VEHICLE_INERTIA] * b[X.VEHICLE_SPEED]
        d[SHAFT_TORQUE, LOAD] += 1.0
    else:
        c[SHAFT_TORQUE] = _shaft(slots)
        d[SHAFT_TORQUE, SHAFT] = 1.0
    return LinearSystem(a, b, c, d, float(slots[P.TORQUE_DELAY]))


def system(p: Array) -> tuple[Array, Array]:
    """A (8 x 8) and B (8 x 6) of the linear part of a packed model, SI units."""
    a, b = np.zeros((X.LINEAR_STATES, X.LINEAR_STATES)), np.zeros((X.LINEAR_STATES, len(INPUTS)))
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
        b[state, :TYRE] = np.array([share, 0.0, -share, -share / n]) / inertia


def _chain(p: Array, a: Array, b: Array) -> None:
    n = p[P.GEAR_RATIO]
    shaft = _shaft(p)
    loss = np.zeros(X.LINEAR_STATES)
    loss[X.ROTOR_SPEED], loss[X.HOUSING_SPEED] = p[P.DRAG], -p[P.DRAG]
    a[X.TWIST] = _twist_rate(p)
    a[X.ROTOR_SPEED] = (-loss - shaft / n) / p[P.MOTOR_INERTIA]
    b[X.ROTOR_SPEED, :TYRE] = np.array([1.0, -1.0 / n, -1.0, 0.0]) / p[P.MOTOR_INERTIA]
    if p[P.HOUSING_INERTIA] > 0.0:
        a[X.HOUSING_ANGLE, X.HOUSING_SPEED] = 1.0
        a[X.HOUSING_SPEED] = (loss - (1.0 - 1.0 / n) * shaft) / p[P.HOUSING_INERTIA]
        a[X.HOUSING_SPEED, X.HOUSING_ANGLE] -= p[P.MOUNT_STIFFNESS] / p[P.HOUSING_INERTIA]
        a[X.HOUSING_SPEED, X.HOUSING_SPEED] -= p[P.MOUNT_DAMPING] / p[P.HOUSING_INERTIA]
        b[X.HOUSING_SPEED, :TYRE] = np.array([-1.0, 1.0 / n - 1.0, 1.0, 0.0]) / p[P.HOUSING_INERTIA]
    if p[P.KIND] == P.TWO_INERTIA:
        a[X.WHEEL_SPEED] = a[X.VEHICLE_SPEED] = shaft / p[P.VEHICLE_INERTIA]
        b[X.WHEEL_SPEED, SHAFT] = b[X.VEHICLE_SPEED, SHAFT] = 1.0 / p[P.VEHICLE_INERTIA]
        b[X.WHEEL_SPEED, LOAD] = b[X.VEHICLE_SPEED, LOAD] = -1.0 / p[P.VEHICLE_INERTIA]
        return
    road = np.zeros(X.LINEAR_STATES)
    road[X.TYRE_TWIST] = p[P.TYRE_STIFFNESS]
    road[X.WHEEL_SPEED], road[X.VEHICLE_SPEED] = p[P.TYRE_DAMPING], -p[P.TYRE_DAMPING]
    a[X.WHEEL_SPEED] = (shaft - road) / p[P.WHEEL_INERTIA]
    b[X.WHEEL_SPEED, SHAFT], b[X.WHEEL_SPEED, TYRE] = 1.0 / p[P.WHEEL_INERTIA], -1.0 / p[P.WHEEL_INERTIA]
    b[X.TYRE_TWIST, TYRE_RATE] = 1.0
    a[X.TYRE_TWIST, X.WHEEL_SPEED], a[X.TYRE_TWIST, X.VEHICLE_SPEED] = 1.0, -1.0
    a[X.VEHICLE_SPEED] = road / p[P.VEHICLE_INERTIA]
    b[X.VEHICLE_SPEED, LOAD] = -1.0 / p[P.VEHICLE_INERTIA]
    b[X.VEHICLE_SPEED, TYRE] = 1.0 / p[P.VEHICLE_INERTIA]


def _twist_rate(p: Array) -> Array:
    """Row that gives the shafts' rate of twist, wheel side, of a state."""
    row, n = np.zeros(X.LINEAR_STATES), p[P.GEAR_RATIO]
    row[X.ROTOR_SPEED], row[X.HOUSING_SPEED], row[X.WHEEL_SPEED] = 1.0 / n, 1.0 - 1.0 / n, -1.0
    return row


def _shaft(p: Array) -> Array:
    """Row that gives the torque of stiffness and damping of the shafts, wheel side, of a state."""
    row = _twist_rate(p)
    row *= p[P.SHAFT_DAMPING]
    row[X.TWIST] += p[P.SHAFT_STIFFNESS]
    return row


@compiled_without_lock
def _respond(a, b, c, d, s, out):  # type: ignore[no-untyped-def]
    """C·(s·1 - A)⁻¹·b + d for each s, by elimination: a library's call costs more than these few states."""
    n = a.shape[0]
    m, x = np.empty((n, n), np.complex128), np.empty(n, np.complex128)
    for f in range(s.shape[0]):
        for i in range(n):
            x[i] = b[i]
            for j in range(n):
                m[i, j] = -a[i, j]
            m[i, i] += s[f]
        _solve(m, x)
        for row in range(c.shape[0]):
            out[row, f] = d[row]
            for i in range(n):
                out[row, f] += c[row, i] * x[i]


@inlined
def _size(z):  # type: ignore[no-untyped-def]
    return abs(z.real) + abs(z.imag)


@compiled
def _solve(m, x):  # type: ignore[no-untyped-def]
    """The solution of m·y = x in place of `x`, with pivots; `m` is used up."""
    n = m.shape[0]
    for i in range(n):
        pivot = i
        for k in range(i + 1, n):
            if _size(m[k, i]) > _size(m[pivot, i]):
                pivot = k
        for j in range(i, n):
            m[i, j], m[pivot, j] = m[pivot, j], m[i, j]
        x[i], x[pivot] = x[pivot], x[i]
        inverse = np.conj(m[i, i]) / (m[i, i].real ** 2 + m[i, i].imag ** 2)
        x[i] *= inverse
        for j in range(i + 1, n):
            m[i, j] *= inverse
        for k in range(i + 1, n):
            if _size(m[k, i]) > 0.0:
                for j in range(i + 1, n):
                    m[k, j] -= m[k, i] * m[i, j]
                x[k] -= m[k, i] * x[i]
    for i in range(n - 2, -1, -1):
        for j in range(i + 1, n):
            x[i] -= m[i, j] * x[j]
