"""How well a fit knows its numbers, errors being what they are: coloured, and partly a model's misfit.

Covariances of least squares hold for white errors of known size. Errors of a fit are neither: noise is
slow, and what a formula has wrong is wrong again wherever the same happens. The sandwich estimator makes no
assumption but that stretches of a few seconds know little of each other: it takes the spread of what each
stretch alone would have the numbers do (H. White, Econometrica 48, 1980; clusters: Liang and Zeger,
Biometrika 73, 1986). Where a number shows in few stretches, the spectrum of the errors says more.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coloured import coloured_spread
from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.thresholds import CLUSTER_S, CLUSTERS

Array = npt.NDArray[np.float64]


def standard_errors(problem: Problem, one: Fit) -> Array:
    """Standard error of each coordinate of a fit, the misfit that is left included.

    The largest of three: that of white errors as large as those that are left, that of errors with the
    spectrum of those, and that of the sandwich; with it how far other fits lie that are as good, and what a
    number that no fit may move may be off by.
    """
    own = np.hypot(_own_errors(problem, one), _held(one)) if one.standard is None else one.standard
    return own if one.scatter is None else np.hypot(own, one.scatter)


def _held(one: Fit) -> Array:
    """What the tolerance of the model's own dead time adds to an extra one: only their sum shows."""
    hypothesis = one.hypothesis
    delay = hypothesis.base.dead_time_s
    return np.array(
        [
            delay * hypothesis.freedom("torque_delay")[1] if c.name == "extra_delay_s" else 0.0
            for c in hypothesis.coordinates()
        ]
    )


def _own_errors(problem: Problem, one: Fit) -> Array:
    """The same without other fits."""
    left = max(1.0, one.cost / max(problem.rows, 1))
    white = np.diag(one.covariance) * left
    spreads = (_spread(problem, one), coloured_spread(one.errors))
    others = [np.diag(one.covariance @ spread @ one.covariance) for spread in spreads]
    return np.asarray(np.sqrt(np.maximum.reduce([white, *others])))


def _spread(problem: Problem, one: Fit) -> Array:
    """Sum over stretches of the outer products of their gradients, coordinates x coordinates."""
    period = problem.traces[0].dt * problem.traces[0].block
    lasts = sum(len(t.measured) for t in problem.traces) * period
    length = max(1, round(min(CLUSTER_S, lasts / CLUSTERS) / period))
    gradients = np.concatenate([_gradients(errors, length) for errors in one.errors])
    count = len(gradients)
    gradients = gradients - gradients.mean(axis=0)  # the prior's pull is no scatter
    return np.asarray(gradients.T @ gradients * count / max(count - 1, 1))


def _gradients(errors: Errors, length: int) -> Array:
    """Gradient of each stretch of `length` blocks, initial values projected out: stretches x coordinates."""
    pulls = errors.slopes * errors.without_starts(errors.rows)[:, None]
    firsts = np.arange(0, len(pulls), 3 * length)  # rows are blocks x 3 channels
    return np.asarray(np.add.reduceat(pulls, firsts, axis=0))
