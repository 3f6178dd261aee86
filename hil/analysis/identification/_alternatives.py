"""What else was fitted beside the model that is taken: each order and each chain as a model of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.identification._identify import Identification, meta_of, physical_of
from hil.analysis.identification._rational_fit import Fit
from hil.analysis.identification._table import model_of
from hil.analysis.identification._trust import Judgement, judge
from hil.core.errors import BadInputError
from hil.core.model import Model

_DRAWS = 200


@dataclass(frozen=True)
class OrderModel:
    """An order that was tried, as a model; `judgement` says whether its standard errors hold."""

    model: Model
    judgement: Judgement


@dataclass(frozen=True)
class Resonance:
    """A pole pair: |p|/2π and -Re p/|p|, with standard errors by draws from the fit's covariance."""

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


def resonances_of(fit: Fit, seed: int = 1) -> tuple[Resonance, ...]:
    """Oscillating pole pairs, lowest first."""
    generator = np.random.default_rng(seed)
    nominal = _pairs(fit.modes.pole_locations())
    drawn = [_pairs(fit.sample(generator).pole_locations()) for _ in range(_DRAWS)]
    same = [one for one in drawn if len(one) == len(nominal)]  # a pair may fall apart into real poles
    errors = np.std(same, axis=0) if len(same) > 1 else np.full(nominal.shape, np.nan)
    return tuple(
        Resonance(float(hz), float(damping), float(hz_error), float(damping_error))
        for (hz, damping), (hz_error, damping_error) in zip(nominal, errors, strict=True)
    )


def _pairs(poles: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """Frequency in Hz and damping ratio of each pole above the real axis, P x 2."""
    above = poles[poles.imag > 1e-9 * np.max(np.abs(poles), initial=1e-300)]
    size = np.abs(above)
    return np.stack([size / (2 * np.pi), -above.real / size], axis=1)
