"""Odds of hypotheses: what each predicts, window by window, with the doubt of so few windows.

The score of a hypothesis is its log likelihood less half the number of its free numbers times log N (G. Schwarz,
Ann. Statist. 6 (1978) 461) less the log of how many sets of so many names there are (J. Chen, Z. Chen, Biometrika
95 (2008) 759). Weights are the mean, over Bayesian bootstraps of the windows, of the softmax of the scores
(pseudo-BMA+: Y. Yao, A. Vehtari, D. Simpson, A. Gelman, Bayesian Analysis 13 (2018) 917). Two names that leave
about the same misfit, one better here and the other there, get modest odds by themselves; where every window
says the same the odds are those of Bayes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb, log

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Point

Array = npt.NDArray[np.float64]

_DRAWS = 1000


@dataclass(frozen=True)
class Candidate:
    """A fitted hypothesis, its log likelihood by window (windows,) and what its size costs."""

    point: Point
    windows: Array
    penalty: float

    @property
    def names(self) -> tuple[str, ...]:
        """Of its effects."""
        return self.point.hypothesis.names

    @property
    def score(self) -> float:
        """Log likelihood less penalty."""
        return float(np.sum(self.windows)) - self.penalty


def penalty_of(names: int, free: int, known: int, values: float) -> float:
    """Of a hypothesis with `names` of `known` effects and `free` numbers, by `values` independent values."""
    return 0.5 * free * log(max(values, 2.0)) + log(comb(max(known, names), names))


def weights_of(candidates: Sequence[Candidate]) -> Array:
    """Posterior weight of each candidate, (candidates,)."""
    windows = np.stack([one.windows for one in candidates])
    penalties = np.array([one.penalty for one in candidates])
    count = windows.shape[1]
    draws = np.random.default_rng(0).exponential(size=(_DRAWS, count))
    draws *= count / draws.sum(axis=1, keepdims=True)
    scores = draws @ windows.T - penalties
    scores -= scores.max(axis=1, keepdims=True)
    likely = np.exp(scores)
    return np.asarray(np.mean(likely / likely.sum(axis=1, keepdims=True), axis=0))
