"""What noise alone would seem to say: the false names that a parametric bootstrap finds.

Theiler et al., Testing for nonlinearity in time series: the method of surrogate data, Physica D 58 (1992).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.probes import probes
from hil.analysis.diagnosis.search.screen import mismatch_columns, probe_columns, products
from hil.analysis.diagnosis.search.thresholds import BOOTSTRAP_DRAWS, ENOUGH_S

Array = npt.NDArray[np.float64]


def most_by_chance(problem: Problem, fit: Fit, draws: int = BOOTSTRAP_DRAWS) -> float:
    """The largest drop of the squared error that any effect would bring if the errors of `fit` were noise.

    A parametric bootstrap of the linearised score: each draw has the spectra of the errors and phases of
    chance, and every effect is held against it, base parameters and initial values refitted. Bounds are left
    out, so it is rather too large than too small.
    """
    rng = np.random.default_rng(0)
    candidates = probes(problem, fit)
    surrogates = {i: _surrogates(fit.errors[i].channels, draws, rng) for i in _liveliest(problem)}
    matrix, gradients = products(problem, fit, candidates, surrogates)
    base = len(fit.theta)
    precision = np.array([problem.misfit / c.prior**2 for c in fit.hypothesis.coordinates()])
    matrix[:base, :base] += np.diag(precision)
    known = np.arange(base)
    rest = _drops(matrix, gradients, known)
    most = 0.0
    for _, columns in probe_columns(candidates, base):
        most = max(most, float(np.max(_drops(matrix, gradients, columns) - rest)))
    for _, index in mismatch_columns(fit.hypothesis):
        freed = matrix.copy()
        freed[index, index] -= precision[index]
        most = max(most, float(np.max(_drops(freed, gradients, known) - rest)))
    return most


def _liveliest(problem: Problem) -> list[int]:
    """Recordings with the most torque, as many as suffice: noise scores no more in longer ones."""
    chosen: list[int] = []
    for index in np.argsort([-float(np.std(t.torque)) for t in problem.traces]).tolist():
        chosen.append(index)
        if sum(len(problem.traces[i].torque) * problem.traces[i].dt for i in chosen) > ENOUGH_S:
            break
    return chosen


def _drops(matrix: Array, gradients: Array, columns: npt.NDArray[np.int_]) -> Array:
    """Drop of the squared error that `columns` bring against each error, without bounds."""
    pulls = gradients[columns]
    found = np.linalg.lstsq(matrix[np.ix_(columns, columns)], pulls, rcond=1e-10)[0]
    return np.asarray(np.sum(pulls * found, axis=0))


def _surrogates(error: Array, draws: int, rng: np.random.Generator) -> Array:
    """Noise with the spectra of `error` (blocks x 3) and phases of chance: rows x draws."""
    spectrum = np.abs(np.fft.rfft(error, axis=0))
    turned = np.exp(2j * np.pi * rng.random((draws, *spectrum.shape)))
    drawn = np.fft.irfft(spectrum * turned, len(error), axis=1)
    return np.asarray(drawn.reshape(draws, -1).T)
