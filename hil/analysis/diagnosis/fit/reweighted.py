"""A fit far from the noise, its errors weighed by their own spectrum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.thresholds import FAR_FROM_NOISE, MISS_WORSE
from hil.analysis.diagnosis.fit.whitening import whitening_of


def reweighted(problem: Problem, best: Fit) -> Fit:
    """Where even the best leaves far more than noise, errors are weighed by their own spectrum.

    Otherwise the strongest resonance alone would set all parameters. Cost and errors that are handed on are
    those of the plain weights. Where the simulation would miss by clearly more, weights stay as they are.
    """
    if not best.hypothesis.terms or best.cost < FAR_FROM_NOISE * problem.rows:
        return best
    plain = best
    for _ in range(3):
        other = problem.whitened(whitening_of(best.errors))
        again = fit(other, best.hypothesis, best.starts, best.theta)
        best = fit(problem, best.hypothesis, again.starts, again.theta, rounds=0)
        # other weights see the fast part of a misfit and think little of what is slow: neither knows it all
        errors = np.maximum(standard_errors(other, again), standard_errors(problem, best))
        best = replace(best, standard=errors, scatter=plain.scatter)
    return best if best.cost < MISS_WORSE**2 * plain.cost else plain
