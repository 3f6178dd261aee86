"""What else was fitted beside the model that is taken: each order and each chain as a model of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hil.analysis.identification._identify import Identification, meta_of, physical_of
from hil.analysis.identification._rational_fit import Fit
from hil.analysis.identification._table import model_of
from hil.analysis.identification._trust import Judgement, judge
from hil.core.errors import BadInputError
from hil.core.model import Model


@dataclass(frozen=True)
class OrderModel:
    """An order that was tried, as a model; `judgement` says whether its standard errors hold."""

    model: Model
    judgement: Judgement


@dataclass(frozen=True)
class Resonance:
    """A pole pair: |p|/2π and -Re p/|p|, with standard errors."""

    frequency_hz: float
    damping: float
    frequency_error_hz: float
    damping_error: float


def order_models(found: Identification) -> tuple[OrderModel | None, ...]:
    """By candidate; None for one that explains less than half of the response."""
    models: list[OrderModel | None] = []
    for one in found.orders.candidates:
        if one is found.orders.best:
            models.append(OrderModel(found.model, found.judgement))
            continue
        try:
            judgement = judge(found.frf, one)
        except BadInputError:
            models.append(None)
            continue
        meta = meta_of(found.frf, one.fit, None, judgement, list(found.model.meta["sources"]))
        models.append(OrderModel(model_of(one.fit, meta), judgement))
    return tuple(models)


def chain_models(found: Identification) -> tuple[Model, ...]:
    """All chains, in the order of `found.chain.fits`; one that does not explain the data says so itself."""
    chain = found.chain
    if chain is None:
        return ()
    corrected = any(text.endswith(": corrected") for text in found.doubts)
    meta, models = found.model.meta, []
    for place, one in enumerate(chain.fits):
        if one is chain.best and found.physical is not None:
            models.append(found.physical)
            continue
        reason = f"{one.model.kind} was fitted too; {chain.reason}"
        other = replace(chain, chosen=place, reason=reason)
        doubt = one.doubt(corrected=corrected)
        models.append(physical_of(other, doubt, found.judgement, meta["sources"], meta["band_hz"]))
    return tuple(models)


def information_criterion(fit: Fit) -> float:
    """BIC = χ² + k ln n of k parameters and n real values whose noise is known (Schwarz 1978).

    Differences count: one that is larger by 10 is much less likely.
    """
    unknowns, values = len(fit.covariance), 2 * fit.residual.size
    return float(fit.chi_square * max(values - unknowns, 1) + unknowns * np.log(values))


def resonances_of(fit: Fit) -> tuple[Resonance, ...]:
    """Oscillating pole pairs, lowest first.

    A section s² + a s + b has ω = √b and ζ = a/(2√b); the covariance is of log a and log b, so that relative
    errors follow from it by Gauss's law.
    """
    found = []
    for section in range(fit.modes.structure.sections):
        at = slice(2 * section, 2 * section + 2)
        a, b = fit.modes.poles[at]
        if a * a >= 4 * b:
            continue
        covariance = fit.covariance[at, at]
        frequency, damping = np.sqrt(b) / (2 * np.pi), a / (2 * np.sqrt(b))
        of_frequency, of_damping = np.array([0.0, 0.5]), np.array([1.0, -0.5])
        errors = [np.sqrt(max(one @ covariance @ one, 0.0)) for one in (of_frequency, of_damping)]
        values = (frequency, damping, frequency * errors[0], damping * errors[1])
        found.append(Resonance(*(float(one) for one in values)))
    return tuple(sorted(found, key=lambda pair: pair.frequency_hz))
