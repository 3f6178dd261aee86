"""Weighted nonlinear least squares in modal form, dead time inside.

For given poles and dead time the modal coefficients follow from linear least squares, so the search
runs over poles and dead time only (variable projection: Golub & Pereyra 1973, with Kaufman's Jacobian),
by Levenberg-Marquardt steps in the logarithm of the pole parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import FrequencyResponse
from hil.analysis.identification._modal import (
    Modes,
    Structure,
    basis,
    basis_derivatives,
    polynomials,
    starting_poles,
)
from hil.core.errors import BadInputError

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

#: No model is believed closer than this, relative to the response; noise-free data would else have
#: infinite weight.
RELATIVE_FLOOR = 3e-4
_DELAY_TRIALS_S = (0.0, 0.004, 0.008, 0.013, 0.02)
_SURE_FOR_START = 0.2
_ITERATIONS = 60
_CONVERGED = 1e-7
_EXACT = 1e-8  # of the expected residual: data without noise are fitted no closer
_SIGNIFICANT = 3.0  # standard errors below which a numerator coefficient counts as zero


@dataclass(frozen=True)
class Fit:
    """A fitted common-denominator model.

    Attributes:
        modes: poles, modal coefficients, dead time.
        outputs: names of the outputs.
        covariance: of [log of the pole parameters, dead time, free modal coefficients by output].
        chi_square: weighted residual per degree of freedom; 1 when only noise is left.
        residual: O x F, (data - model) divided by its expected deviation.
    """

    modes: Modes
    outputs: tuple[str, ...]
    covariance: Array
    chi_square: float
    residual: ComplexArray

    @property
    def delay_error_s(self) -> float:
        """Standard error of the dead time in seconds."""
        return float(np.sqrt(self.covariance[self._delay_index, self._delay_index]))

    @property
    def _delay_index(self) -> int:
        return self.modes.structure.pole_parameters

    @property
    def integrates(self) -> bool:
        """Whether the pole at the origin shows in any output, by three standard errors."""
        if not self.modes.structure.integrator:
            return False
        (numerators, _), (errors, _) = self.polynomials(), self.coefficient_errors()
        return any(abs(n[-1]) > _SIGNIFICANT * e[-1] for n, e in zip(numerators, errors, strict=True))

    def polynomials(self) -> tuple[list[Array], Array]:
        """Numerators and monic denominator in descending powers of s."""
        numerators, denominator = polynomials(self.modes.structure, self.modes.poles, self.modes.coefficients)
        return [np.asarray(n, float) for n in numerators], np.asarray(denominator, float)

    def coefficient_errors(self) -> tuple[list[Array], Array]:
        """Standard errors in the shape of `polynomials` (complex-step derivatives of exact formulas)."""
        jacobian = np.array([self._step(k) for k in range(len(self.covariance))]).T
        deviation = np.sqrt(np.maximum(np.sum(jacobian @ self.covariance * jacobian, axis=1), 0.0))
        order = self.modes.structure.order
        numerators = [deviation[i * order : (i + 1) * order] for i in range(len(self.outputs))]
        return numerators, deviation[len(self.outputs) * order :]

    def _step(self, parameter: int) -> Array:
        step = 1e-30
        modes, structure = self.modes, self.modes.structure
        poles = modes.poles.astype(complex)
        coefficients = modes.coefficients.astype(complex)
        if parameter < structure.pole_parameters:
            poles[parameter] *= 1 + 1j * step
        elif parameter > structure.pole_parameters:
            place = parameter - structure.pole_parameters - 1
            for output in range(len(self.outputs)):
                free = structure.free_coefficients(output)
                if place < free.shape[1]:
                    coefficients[output] += 1j * step * free[:, place]
                    break
                place -= free.shape[1]
        numerators, denominator = polynomials(structure, poles, coefficients)
        return np.concatenate([*numerators, denominator]).imag / step

    def sample(self, generator: np.random.Generator) -> Modes:
        """Modes drawn from the fit's uncertainty."""
        scale = np.sqrt(np.maximum(np.diag(self.covariance), 1e-300))
        values, vectors = np.linalg.eigh(self.covariance / scale[:, None] / scale)
        normal = generator.standard_normal(len(values))
        draw = scale * (vectors @ (np.sqrt(np.maximum(values, 0.0)) * normal))
        structure = self.modes.structure
        count = structure.pole_parameters
        coefficients = self.modes.coefficients.copy()
        place = count + 1
        for output in range(len(self.outputs)):
            free = structure.free_coefficients(output)
            coefficients[output] += free @ draw[place : place + free.shape[1]]
            place += free.shape[1]
        return Modes(
            structure,
            self.modes.poles * np.exp(draw[:count]),
            coefficients,
            max(0.0, self.modes.delay_s + float(draw[count])),
        )


def fit(
    frf: FrequencyResponse,
    order: int,
    *,
    integrator: bool = True,
    start: Modes | None = None,
    prune: bool = True,
    rows: npt.NDArray[np.bool_] | None = None,
) -> Fit:
    """Fit all outputs of `frf` over one denominator of `order` with one dead time.

    Args:
        frf: the data; each value is weighted by its standard deviation.
        order: order of the denominator, the integrator included.
        integrator: whether a pole lies at the origin.
        start: modes to start from instead of vector fitting; their structure is kept.
        prune: set to exactly zero what the data show to be zero: the integrator of an output that does
            not integrate, and leading numerator coefficients within 3 standard errors of zero.
        rows: use only these frequencies.

    Raises:
        BadInputError: an order below 1, or more unknowns than data.
    """
    outputs = len(frf.outputs)
    if order < 1 + integrator:
        raise BadInputError(f"order {order} is too low", fix="give 2 or more")
    problem = _Problem(frf, rows)
    if problem.values <= 2 * (outputs + 1) * order:
        raise BadInputError(
            f"{problem.values // 2} values of the frequency response are too few for order {order}",
            fix="record longer, or widen the band with --from-hz and --to-hz",
        )
    if start is not None:
        found = problem.solve(start.structure, start.poles, start.delay_s)
    else:
        free = order - integrator
        structure = Structure(integrator, free // 2, free % 2 == 1, (integrator,) * outputs, (1,) * outputs)
        found = problem.solve(structure, *problem.best_start(structure))
    result = problem.finish(found, frf.outputs)
    if prune and start is None:
        smaller = _pruned(result)
        if smaller != result.modes.structure:
            found = problem.solve(smaller, result.modes.poles, result.modes.delay_s)
            result = problem.finish(found, frf.outputs)
    return result


def _pruned(result: Fit) -> Structure:
    """Structure without what is within three standard errors of zero."""
    structure = result.modes.structure
    numerators, _ = result.polynomials()
    errors, _ = result.coefficient_errors()
    integrating = tuple(
        flag and bool(abs(n[-1]) > _SIGNIFICANT * e[-1])
        for flag, n, e in zip(structure.integrating, numerators, errors, strict=True)
    )
    roll_off = tuple(
        2 if abs(n[0]) <= _SIGNIFICANT * e[0] else 1 for n, e in zip(numerators, errors, strict=True)
    )
    if structure.integrator and not any(integrating):
        integrating = structure.integrating
    return replace(structure, integrating=integrating, roll_off=roll_off)


@dataclass
class _Point:
    """One evaluation: residual, and what the Jacobian needs."""

    structure: Structure
    poles: Array
    delay_s: float
    cost: float
    residuals: list[Array]
    orthogonal: list[Array]
    coefficients: Array


class _Problem:
    """Data, weights and the projected least-squares problem."""

    def __init__(self, frf: FrequencyResponse, rows: npt.NDArray[np.bool_] | None) -> None:
        part = slice(None) if rows is None else rows
        self.frequency_hz = frf.frequency_hz[part]
        self.s: ComplexArray = np.asarray(2j * np.pi * self.frequency_hz)
        self.response = frf.response[:, part]
        # sqrt 2: real and imaginary part each hold half of the variance.
        self.weight = np.sqrt(2) / expected_deviation(frf)[:, part]
        self.values = 2 * self.response.size

    def best_start(self, structure: Structure) -> tuple[Array, float]:
        """Poles and dead time of the vector fitting that leaves least after a few refining steps."""
        # Vector fitting weights all values alike: those that are mostly noise would lead it astray.
        sure = np.all(self.weight * np.abs(self.response) > np.sqrt(2) / _SURE_FOR_START, axis=0)
        if np.sum(sure) < 4 * structure.order:
            sure[:] = True
        trials = []
        for delay in (*_DELAY_TRIALS_S, *self._long_delays(sure)):
            poles = starting_poles(self.frequency_hz[sure], self.response[:, sure], structure, delay)
            found = self.solve(structure, poles, delay, iterations=4)
            trials.append((found.cost, found.poles, found.delay_s))
        _, poles, delay = min(trials, key=lambda trial: trial[0])
        return poles, delay

    def _long_delays(self, sure: npt.NDArray[np.bool_]) -> list[float]:
        """Dead times beyond the usual trials, of the phase's slope: poles turn it by little."""
        response, frequency_hz = self.response[:, sure], self.frequency_hz[sure]
        turn = np.angle(response[:, 1:] * response[:, :-1].conj())
        slope_s = -turn / (2 * np.pi * np.diff(frequency_hz))
        said_s = float(np.median(slope_s))
        if not said_s > _DELAY_TRIALS_S[-1]:
            return []
        return [said_s, max(said_s - _DELAY_TRIALS_S[-1], _DELAY_TRIALS_S[-1])]

    def evaluate(self, structure: Structure, poles: Array, delay_s: float) -> _Point:
        """Project the data on the modes of these poles."""
        modes = basis(structure, poles, self.s)
        turned = self.response * np.exp(delay_s * self.s)
        residuals, orthogonal = [], []
        coefficients = np.empty((len(self.response), structure.order))
        cost = 0.0
        for output, weight in enumerate(self.weight):
            free = structure.free_coefficients(output)
            matrix = _stack(weight[:, None] * (modes @ free))
            scale = 1 / np.maximum(np.sqrt(np.sum(matrix**2, axis=0)), 1e-300)
            q, r = np.linalg.qr(matrix * scale)
            data = _stack(weight * turned[output])
            projected = q.T @ data
            residual = data - q @ projected
            coefficients[output] = free @ (scale * np.linalg.lstsq(r, projected, rcond=1e-13)[0])
            cost += float(residual @ residual)
            residuals.append(residual)
            orthogonal.append(q)
        return _Point(structure, poles, delay_s, cost, residuals, orthogonal, coefficients)

    def columns(self, point: _Point, output: int) -> Array:
        """Derivatives of the weighted model by log pole parameters and dead time (2F x parameters)."""
        weight = self.weight[output]
        row = point.coefficients[output]
        changes = basis_derivatives(point.structure, point.poles, self.s)
        columns = [
            weight * (derivative @ row[place]) * value
            for (place, derivative), value in zip(changes, point.poles, strict=True)
        ]
        turned = self.response[output] * np.exp(point.delay_s * self.s)
        columns.append(-weight * self.s * turned)
        return _stack(np.stack(columns, axis=1))

    def solve(
        self, structure: Structure, poles: Array, delay_s: float, iterations: int = _ITERATIONS
    ) -> _Point:
        """Levenberg-Marquardt from these poles and this dead time."""
        point = self.evaluate(structure, poles, delay_s)
        damping, standing = 1e-3, 0
        for _ in range(iterations):
            gradient, curvature = self._normal_equations(point)
            diagonal = np.diag(curvature) + 1e-300
            for _ in range(12):
                step = np.linalg.solve(curvature + damping * np.diag(diagonal), gradient)
                trial = self.evaluate(
                    structure,
                    point.poles * np.exp(np.clip(step[:-1], -1.0, 1.0)),
                    max(0.0, point.delay_s + float(step[-1])),
                )
                if trial.cost < point.cost:
                    break
                damping *= 4
            else:
                return point
            standing = standing + 1 if point.cost - trial.cost < _CONVERGED * point.cost else 0
            point, damping = trial, damping / 6
            if standing == 2 or point.cost < _EXACT * self.values:
                break
        return point

    def _normal_equations(self, point: _Point) -> tuple[Array, Array]:
        count = point.structure.pole_parameters + 1
        gradient, curvature = np.zeros(count), np.zeros((count, count))
        for output, (q, residual) in enumerate(zip(point.orthogonal, point.residuals, strict=True)):
            columns = self.columns(point, output)
            columns -= q @ (q.T @ columns)
            gradient += columns.T @ residual
            curvature += columns.T @ columns
        return gradient, curvature

    def finish(self, point: _Point, outputs: tuple[str, ...]) -> Fit:
        """Covariance and normalised residual at the optimum."""
        structure = point.structure
        modes = Modes(structure, point.poles, point.coefficients, point.delay_s)
        free = [structure.free_coefficients(o) for o in range(len(outputs))]
        shared = structure.pole_parameters + 1
        unknowns = shared + sum(f.shape[1] for f in free)
        information = np.zeros((unknowns, unknowns))
        values = basis(structure, point.poles, self.s)
        place = shared
        for output, weight in enumerate(self.weight):
            own = _stack(weight[:, None] * (values @ free[output]))
            columns = self.columns(point, output)
            part = slice(place, place + own.shape[1])
            information[:shared, :shared] += columns.T @ columns
            information[:shared, part] = columns.T @ own
            information[part, :shared] = information[:shared, part].T
            information[part, part] = own.T @ own
            place += own.shape[1]
        chi_square = point.cost / max(self.values - unknowns, 1)
        covariance = max(chi_square, 1.0) * _inverse(information)
        residual = (self.response - modes.response(self.frequency_hz)) * self.weight / np.sqrt(2)
        return Fit(modes, outputs, covariance, chi_square, residual)


def expected_deviation(frf: FrequencyResponse) -> Array:
    """O x F deviation that weights the fit: the data's own, never below 0.03 % of the response."""
    return np.hypot(frf.standard_deviation, RELATIVE_FLOOR * np.abs(frf.response))


def _inverse(information: Array) -> Array:
    """Inverse of a symmetric matrix whose diagonal spans many decades."""
    scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    return np.asarray(
        np.linalg.pinv(information * scale[:, None] * scale, rcond=1e-14, hermitian=True)
        * scale[:, None]
        * scale
    )


def _stack(values: ComplexArray | Sequence[complex]) -> Array:
    array = np.asarray(values)
    return np.concatenate([array.real, array.imag])
