"""Transfer functions as a sum of modes over common poles: well conditioned, stable by construction.

H_o(s) = exp(-τ s) · [ r_o/s + Σ_j (b1_oj s + b0_oj)/(s² + c1_j s + c0_j) + g_o/(s + a) ]

The sections have real coefficients with c1, c0, a > 0, so every pole lies in the left half plane
whatever the fit does, and one section covers a resonance as well as two real poles. The integrator is
exact: its pole is 0.0, and an output without it gets an exact zero at the origin.

Starting poles by vector fitting (scikit-rf), with a scan of the dead time around it.

Gustavsen & Semlyen, IEEE Trans. Power Delivery 14 (1999) 1052. Vector fitting knows no dead time: with
8 ms left in, its poles are worthless (relative error 2.36). So it runs on data from which a trial dead
time was removed, for some trials, and what fits best starts the least squares.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Structure:
    """How many poles of each sort, and what is known of the numerators.

    Attributes:
        integrator: a pole at the origin.
        sections: number of second-order sections.
        real_pole: one first-order section.
        integrating: for each output, whether it has the pole at the origin.
        roll_off: for each output, least difference of denominator and numerator order, 1 or 2.
    """

    integrator: bool
    sections: int
    real_pole: bool
    integrating: tuple[bool, ...]
    roll_off: tuple[int, ...]

    @property
    def order(self) -> int:
        """Order of the denominator."""
        return int(self.integrator) + 2 * self.sections + int(self.real_pole)

    @property
    def pole_parameters(self) -> int:
        """Number of free denominator coefficients."""
        return 2 * self.sections + int(self.real_pole)

    def free_coefficients(self, output: int) -> Array:
        """Basis (order x free) of the modal coefficients that the knowledge of one output leaves.

        Columns are orthonormal; the coefficients of an output are this matrix times the free ones.
        """
        constraints = []
        if self.integrator and not self.integrating[output]:
            constraints.append(np.eye(self.order)[0])
        if self.roll_off[output] == 2:
            constraints.append(self._leading())
        if not constraints:
            return np.eye(self.order)
        _, singular, rows = np.linalg.svd(np.array(constraints))
        return np.asarray(rows[int(np.sum(singular > 1e-12)) :].T)

    def _leading(self) -> Array:
        """Row whose product with the modal coefficients is the numerator's leading coefficient."""
        row = [1.0] * self.integrator + [1.0, 0.0] * self.sections + [1.0] * self.real_pole
        return np.array(row)


@dataclass(frozen=True)
class Modes:
    """Values that go with a `Structure`: poles (c1, c0 of each section, then a), O x order coefficients."""

    structure: Structure
    poles: Array
    coefficients: Array
    delay_s: float

    def response(self, frequency_hz: Array) -> ComplexArray:
        """O x F complex responses."""
        s = 2j * np.pi * np.asarray(frequency_hz, dtype=float)
        return np.asarray(
            (self.coefficients @ basis(self.structure, self.poles, s).T) * np.exp(-self.delay_s * s)
        )

    def pole_locations(self) -> ComplexArray:
        """Roots of the denominator in rad/s, sorted by magnitude."""
        c = self.poles
        roots: list[npt.NDArray[np.inexact]] = [np.zeros(1)] if self.structure.integrator else []
        roots += [np.roots([1.0, c[2 * j], c[2 * j + 1]]) for j in range(self.structure.sections)]
        roots += [-c[-1:]] if self.structure.real_pole else []
        every = np.concatenate(roots).astype(complex)
        return every[np.lexsort((every.imag, np.abs(every)))]


def basis(structure: Structure, poles: Array, s: ComplexArray) -> ComplexArray:
    """F x order values of the modes at s; columns in the order of the docstring of this file."""
    columns = [1 / s] if structure.integrator else []
    for j in range(structure.sections):
        section = 1 / (s * s + poles[2 * j] * s + poles[2 * j + 1])
        columns += [s * section, section]
    if structure.real_pole:
        columns.append(1 / (s + poles[-1]))
    return np.stack(columns, axis=1)


def basis_derivatives(
    structure: Structure, poles: Array, s: ComplexArray
) -> list[tuple[slice, ComplexArray]]:
    """For each pole parameter: the columns it changes, and their derivatives (F x columns)."""
    first = int(structure.integrator)
    derivatives = []
    for j in range(structure.sections):
        squared = 1 / (s * s + poles[2 * j] * s + poles[2 * j + 1]) ** 2
        place = slice(first + 2 * j, first + 2 * j + 2)
        derivatives.append((place, np.stack([-s * s * squared, -s * squared], axis=1)))
        derivatives.append((place, np.stack([-s * squared, -squared], axis=1)))
    if structure.real_pole:
        derivatives.append(
            (slice(structure.order - 1, structure.order), (-1 / (s + poles[-1]) ** 2)[:, None])
        )
    return derivatives


def polynomials(
    structure: Structure, poles: npt.NDArray[np.inexact], coefficients: npt.NDArray[np.inexact]
) -> tuple[list[npt.NDArray[np.inexact]], npt.NDArray[np.inexact]]:
    """Numerators (order coefficients each) and monic denominator (order + 1), descending powers of s.

    With an integrator the denominator ends in an exact 0, and so does the numerator of an output that
    does not integrate; a numerator with roll-off 2 starts with an exact 0. Complex arguments give
    complex-step derivatives.
    """
    factors: list[Sequence[object]] = [[1.0, 0.0]] if structure.integrator else []
    factors += [[1.0, poles[2 * j], poles[2 * j + 1]] for j in range(structure.sections)]
    factors += [[1.0, poles[-1]]] if structure.real_pole else []
    kind = np.result_type(poles, coefficients)
    denominator = _product(factors, kind)
    numerators = []
    for output, row in enumerate(coefficients):
        total = np.zeros(structure.order, kind)
        place = 0
        for number, factor in enumerate(factors):
            own = row[place : place + len(factor) - 1]
            place += len(factor) - 1
            if structure.integrator and number == 0 and not structure.integrating[output]:
                continue
            others = _product([f for other, f in enumerate(factors) if other != number], kind)
            total += np.convolve(own, others)
        if structure.roll_off[output] == 2:
            total[0] = 0.0
        numerators.append(total)
    return numerators, denominator


def _product(factors: Sequence[Sequence[object]], kind: npt.DTypeLike) -> npt.NDArray[np.inexact]:
    product = np.ones(1, kind)
    for factor in factors:
        product = np.convolve(product, np.asarray(factor, kind))
    return product


_ITERATIONS = 4


def starting_poles(
    frequency_hz: Array, response: ComplexArray, structure: Structure, delay_s: float
) -> Array:
    """Pole parameters of `structure` for data that carry about `delay_s` of dead time.

    Args:
        frequency_hz: F frequencies.
        response: O x F responses.
        structure: how many sections; a pole at the origin is taken out by multiplying with s.
        delay_s: trial dead time.
    """
    from skrf import Network
    from skrf.vectorFitting import VectorFitting

    s = 2j * np.pi * frequency_hz
    data = response * np.exp(delay_s * s) * (s if structure.integrator else 1.0)
    data = data / np.sqrt(np.mean(np.abs(data) ** 2, axis=1, keepdims=True))
    # Above one everywhere, the first value tells scikit-rf that this is no passive network; its test
    # of every frequency would take longer than the fit.
    data = data / max(0.5 * float(np.min(np.abs(data))), 1e-12)
    ports = int(np.ceil(np.sqrt(len(data))))
    matrix = data[np.arange(ports * ports) % len(data)].T.reshape(-1, ports, ports)
    fitting = VectorFitting(Network(f=frequency_hz, s=matrix, f_unit="hz"))
    fitting.max_iterations = _ITERATIONS
    fitting.poles = _spread(frequency_hz, structure)
    with warnings.catch_warnings():
        # It warns that it was stopped after few iterations (they are a start only) and that an axle
        # is not a passive network.
        warnings.simplefilter("ignore")
        fitting.vector_fit(init_pole_spacing="custom", fit_constant=structure.integrator)
    return pole_parameters(np.asarray(fitting.poles), structure)


def pole_parameters(poles: ComplexArray, structure: Structure) -> Array:
    """Section coefficients of `structure` for poles of which conjugates are left out.

    Real poles are paired into sections; what is missing in number is filled with the fastest pole.
    """
    pairs = [p for p in poles if p.imag != 0]
    real = sorted(-float(p.real) for p in poles if p.imag == 0)
    sections = [(-2 * float(p.real), float(abs(p)) ** 2) for p in pairs]
    single = real.pop() if structure.real_pole and len(real) % 2 else None
    while len(real) >= 2:
        a, b = real.pop(), real.pop()
        sections.append((a + b, a * b))
    fastest = max((c0 for _, c0 in sections), default=1e4)
    while len(sections) < structure.sections:
        sections.append((float(np.sqrt(fastest)), fastest))
    values = [value for section in sections[: structure.sections] for value in section]
    if structure.real_pole:
        values.append(single if single is not None else float(np.sqrt(fastest)))
    return np.asarray(np.maximum(np.array(values), 1e-6))


def _spread(frequency_hz: Array, structure: Structure) -> ComplexArray:
    """Lightly damped poles over the upper part of the band, where an axle has its modes."""
    low = max(float(frequency_hz[0]), float(frequency_hz[-1]) / 30)
    omega = 2 * np.pi * np.geomspace(low, 0.7 * float(frequency_hz[-1]), max(structure.sections, 1))
    poles = (-0.3 + 1j) * omega[: structure.sections]
    if structure.real_pole:
        poles = np.append(poles, -2 * np.pi * float(frequency_hz[-1]) / 3)
    return np.asarray(poles, complex)
