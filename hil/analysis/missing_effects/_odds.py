"""Odds of hypotheses: what each predicts, window by window, with the doubt of so few windows.

The score of a hypothesis is its log likelihood less half the number of its free numbers times log N (G.
Schwarz, Ann. Statist. 6 (1978) 461) less the log of how many sets of so many names there are (J. Chen, Z.
Chen, Biometrika 95 (2008) 759), with the prior of the base's numbers. Weights are the mean, over Bayesian
bootstraps of the windows, of the softmax of the scores (pseudo-BMA+: Y. Yao, A. Vehtari, D. Simpson, A.
Gelman, Bayesian Analysis 13 (2018) 917). Two names that leave about the same misfit, one better here and the
other there, get modest odds by themselves; where every window says the same the odds are those of Bayes.
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
ALIKE = log(20.0)
"""Two hypotheses are alike where the data would give the right one odds below 20:1."""


@dataclass(frozen=True)
class Candidate:
    """A fitted hypothesis, log likelihood by window (windows,), free numbers, names to choose from.

    `prior` is the logarithm of the density of its base's numbers; `places` that of how many places were
    looked at for a line that may be anywhere.
    """

    point: Point
    windows: Array
    free: int
    known: int
    prior: float = 0.0
    places: float = 0.0

    @property
    def names(self) -> tuple[str, ...]:
        """Of its effects."""
        return self.point.hypothesis.names

    @property
    def log_likelihood(self) -> float:
        """Of all windows."""
        return float(np.sum(self.windows))

    def score(self, values: float) -> float:
        """Log likelihood, with its prior, less what its size costs."""
        return self.log_likelihood + self.prior - self.cost(values)

    def cost(self, values: float) -> float:
        """What its size costs where the data hold so many independent values."""
        return 0.5 * self.free * log(max(values, 2.0)) + log(comb(self.known, len(self.names))) + self.places


def remains(had: Array, has: Array, noise: Array, most: Array) -> float:
    """Share of the variance beyond noise that stays, mean of channels; those with little count less.

    Where all that stays may be slow noise, nothing stays if what was taken off is more than that.

    Args:
        had: mean square of errors before, (3,); NaN where a channel was not recorded.
        has: the same after.
        noise: variance of proven noise, (3,).
        most: variance that may be noise, (3,), which no name takes off.
    """
    there = np.isfinite(had)
    had, has, noise, most = had[there], has[there], noise[there], most[there]
    off, rest = had - has, np.maximum(has - most, 0.0)
    if not rest.any():
        unproven = float(np.sum(np.maximum(has - noise, 0.0) / noise))
        taken = float(np.sum(off / noise))
        return 0.0 if taken > unproven else min(unproven / max(taken + unproven, 1e-300), 1.0)
    whole = off + rest
    weight = np.minimum(np.maximum(whole, rest) / noise, 1.0)
    share = np.minimum(rest / np.maximum(whole, 1e-300), 2.0)
    return float(min(np.sum(np.maximum(weight, 0.0) * share) / np.sum(np.maximum(weight, 0.0)), 1.0))


def weights_of(candidates: Sequence[Candidate], windows: Array, values: float) -> Array:
    """Posterior weight of each candidate, (candidates,), where the data hold so many independent values.

    Args:
        windows: log likelihoods, candidates x windows, in which what is shown again and again counts once.
    """
    penalties = np.array([one.log_likelihood - one.score(values) for one in candidates])
    count = windows.shape[1]
    draws = np.random.default_rng(0).exponential(size=(_DRAWS, count))
    draws *= count / draws.sum(axis=1, keepdims=True)
    scores = draws @ windows.T - penalties
    scores -= scores.max(axis=1, keepdims=True)
    likely = np.exp(scores)
    return np.asarray(np.mean(likely / likely.sum(axis=1, keepdims=True), axis=0))
