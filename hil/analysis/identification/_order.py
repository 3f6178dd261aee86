"""The order that the data ask for: what each leaves on data it has not seen, and whether that is noise."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import special

from hil.analysis.frequency_response import FrequencyResponse
from hil.analysis.identification._rational_fit import Fit, expected_deviation, fit
from hil.core.errors import BadInputError

logger = logging.getLogger(__name__)

Array = npt.NDArray[np.float64]

#: Orders that are tried; the RMCU's filters hold at most 7 (hil.core.controller.LARGEST_ORDER).
ORDERS = (2, 3, 4, 5, 6, 7)
_FOLDS = 3
_BLOCK = 6
_WORTHWHILE = 0.8
_NEGLIGIBLE = 0.005
_LAGS = 10
_SURE = 0.2  # of the response: noise below this


@dataclass(frozen=True)
class Candidate:
    """One order and the evidence for it.

    Attributes:
        fit: the fit to all data.
        held_out: mean squared error on data left out of the fit, in noise variances; 1 is noise.
        excess: rms relative error on data left out, beyond what noise explains, where noise is small.
        whiteness: smallest p-value over the outputs of a Ljung-Box test along frequency; below 0.01 the
            residual still has a shape.
    """

    fit: Fit
    held_out: float
    excess: float
    whiteness: float

    @property
    def order(self) -> int:
        """Order of the denominator."""
        return self.fit.modes.structure.order

    @property
    def integrator(self) -> bool:
        """Whether a pole lies at the origin."""
        return self.fit.modes.structure.integrator


@dataclass(frozen=True)
class OrderChoice:
    """All candidates, and which one was taken."""

    candidates: tuple[Candidate, ...]
    chosen: int

    @property
    def best(self) -> Candidate:
        """The candidate that was taken."""
        return self.candidates[self.chosen]


def choose_order(
    frf: FrequencyResponse,
    orders: Sequence[int] = ORDERS,
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> OrderChoice:
    """Fit each order with a pole at the origin, take one, and ask whether its pole is at the origin.

    Taken is the smallest order that no higher one beats by a fifth of its held-out error, or whose
    held-out error exceeds the noise by less than 0.5 % of the response: on low-noise data an ever
    higher order fits ever better, by nothing that matters.

    Raises:
        BadInputError: no order could be fitted to so few data.
    """
    candidates = []
    for order in orders:
        progress(f"order {order}")
        try:
            candidates.append(evaluate(frf, order, integrator=True))
        except BadInputError:
            if not candidates:
                raise
            break
    best = min(c.held_out for c in candidates)
    chosen = next(
        i for i, c in enumerate(candidates) if best >= _WORTHWHILE * c.held_out or c.excess <= _NEGLIGIBLE
    )
    progress("pole at the origin")
    logger.info("order %d of %s", candidates[chosen].order, ", ".join(str(c.order) for c in candidates))
    free = evaluate(frf, candidates[chosen].order, integrator=False)
    taken = candidates[chosen]
    candidates.append(free)
    better = free.held_out < _WORTHWHILE * taken.held_out and taken.excess > _NEGLIGIBLE
    if better or not taken.fit.integrates:
        chosen = len(candidates) - 1
    return OrderChoice(tuple(candidates), chosen)


def evaluate(frf: FrequencyResponse, order: int, *, integrator: bool) -> Candidate:
    """Fit one order to all data, and to all but a third for each third in turn.

    The thirds consist of blocks of neighbours, because neighbours share data.
    """
    whole = fit(frf, order, integrator=integrator)
    fold = np.arange(len(frf.frequency_hz)) // _BLOCK % _FOLDS
    deviation = expected_deviation(frf)
    error = np.empty(frf.response.shape, complex)
    for number in range(_FOLDS):
        left_out = fold == number
        if not left_out.any():
            continue
        part = fit(frf, order, integrator=integrator, start=whole.modes, rows=~left_out)
        error[:, left_out] = frf.response[:, left_out] - part.modes.response(frf.frequency_hz[left_out])
    size = np.abs(frf.response)
    excess = _excess(np.abs(error), deviation, size)
    held_out = float(np.mean(np.abs(error / deviation) ** 2))
    whiteness = min(_ljung_box(row[:: frf.independent_every]) for row in whole.residual)
    return Candidate(whole, held_out, excess, whiteness)


def _excess(error: Array, deviation: Array, size: Array) -> float:
    """Rms relative error beyond noise, over the values that noise leaves sure.

    A few values that are mostly noise would outweigh all others, and hide a fit that misses everything.
    """
    sure = deviation < _SURE * size
    if not sure.any():
        sure = np.ones(size.shape, bool)
    beyond = float(np.mean((error[sure] / size[sure]) ** 2) - np.mean((deviation[sure] / size[sure]) ** 2))
    return float(np.sqrt(max(beyond, 0.0)))


def _ljung_box(residual: npt.NDArray[np.complex128]) -> float:
    """p-value for 'no correlation over the first ten lags' of a complex sequence."""
    count = len(residual)
    lags = min(_LAGS, count // 4)
    power = float(np.sum(np.abs(residual) ** 2))
    if lags < 1 or power == 0:
        return 1.0
    statistic = 0.0
    for lag in range(1, lags + 1):
        correlation = abs(np.sum(residual[lag:] * residual[:-lag].conj())) / power
        # A complex correlation coefficient has variance 1/n, half of it in each part.
        statistic += 2 * count * (count + 2) / (count - lag) * correlation**2
    return float(special.chdtrc(2 * lags, statistic))
