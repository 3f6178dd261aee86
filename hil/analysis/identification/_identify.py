"""The whole way from experiments to models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hil.analysis.frequency_response import Experiment, FrequencyResponse, Method, estimate
from hil.analysis.identification._chain_fit import ChainChoice, choose_chain
from hil.analysis.identification._channel_skew import in_step, moments_of, timings_of
from hil.analysis.identification._mistakes import refuse_mistakes
from hil.analysis.identification._order import ORDERS, OrderChoice, choose_order
from hil.analysis.identification._rational_fit import Fit
from hil.analysis.identification._table import model_of
from hil.analysis.identification._trust import Judgement, Trust, judge
from hil.analysis.plausible import within_floating_point
from hil.core.channels import OUTPUTS
from hil.core.model import Model


@dataclass(frozen=True)
class Identification:
    """What `hil identify` finds; `chain` and `physical` are None without motor speed and another output.

    `judgement` tells whether the model may be trusted. A doubtful one carries `[meta] warning`.
    `doubts` (also in `notes`) say which channels may be in another unit or turned.
    """

    frf: FrequencyResponse
    orders: OrderChoice
    chain: ChainChoice | None
    model: Model
    physical: Model | None
    notes: tuple[str, ...]
    judgement: Judgement
    doubts: tuple[str, ...] = ()

    @property
    def verdict(self) -> Trust:
        """'linear' when the model may be trusted with its standard errors, else 'doubtful'."""
        return self.judgement.verdict

    @property
    def warnings(self) -> tuple[str, ...]:
        """Why the model is doubtful, for people; empty when it is not."""
        return self.judgement.warnings

    @property
    def fit(self) -> Fit:
        """The rational fit that was taken."""
        return self.orders.best.fit


def identify(
    experiments: Sequence[Experiment],
    *,
    from_hz: float | None = None,
    to_hz: float | None = None,
    method: Method = "auto",
    order: int | None = None,
    gear_ratio: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Identification:
    """Frequency response, rational fit with dead time, and driveline chain.

    Args:
        experiments: what to use, together.
        from_hz: see `estimate`.
        to_hz: see `estimate`.
        method: see `estimate`.
        order: order of the denominator; None lets the data choose.
        gear_ratio: known gear ratio of the chain.
        progress: called with what is being done.

    Raises:
        UnfitDataError: the data cannot give a frequency response.
        BadInputError: arguments that make no sense, too few data, channels that are swapped, inverted or in
            another unit, or data that no linear model explains.
    """
    with within_floating_point(", ".join(experiment.name for experiment in experiments)):
        progress("frequency response")
        frf = estimate(experiments, from_hz=from_hz, to_hz=to_hz, method=method)
        progress("timing of the channels")
        moment_s = moments_of(experiments, frf.frequency_hz)
        timings = timings_of(frf, moment_s, gear_ratio)
        frf = in_step(frf, timings, moment_s)
        doubts = (
            *(f"{one.in_words(name)}: corrected" for name, one in timings.items()),
            *refuse_mistakes(experiments, frf, gear_ratio),
        )
        orders = choose_order(frf, ORDERS if order is None else (order,), progress=progress)
        return _identified(experiments, frf, orders, doubts, gear_ratio, progress, corrected=bool(timings))


def _identified(
    experiments: Sequence[Experiment],
    frf: FrequencyResponse,
    orders: OrderChoice,
    doubts: tuple[str, ...],
    gear_ratio: float | None,
    progress: Callable[[str], None],
    *,
    corrected: bool,
) -> Identification:
    """Judgement, chain and models of an order that was taken."""
    fit = orders.best.fit
    judgement = judge(frf, orders.best)
    doubts = (*doubts, *judgement.unseen)
    notes = [*frf.notes, *doubts]
    chain, doubt = None, ""
    if OUTPUTS[0] in frf.outputs and len(frf.outputs) > 1:
        chain = choose_chain(frf, gear_ratio=gear_ratio, torque_delay_s=fit.modes.delay_s, progress=progress)
        if not chain.best.explains:
            notes.append(chain.reason)
        doubt = chain.best.doubt(corrected=corrected)
        if doubt:
            doubts = (*doubts, doubt)
            notes.append(doubt)
    else:
        notes.append(f"no chain was fitted: that needs '{OUTPUTS[0]}' and another output")
    sources = [experiment.name for experiment in experiments]
    model = model_of(fit, meta_of(frf, fit, chain, judgement, sources))
    physical = None if chain is None else physical_of(chain, doubt, judgement, sources, model.meta["band_hz"])
    return Identification(frf, orders, chain, model, physical, tuple(notes), judgement, doubts)


def meta_of(
    frf: FrequencyResponse, fit: Fit, chain: ChainChoice | None, judgement: Judgement, sources: list[str]
) -> dict[str, object]:
    """What a model's file says beside the functions; standard errors only where they hold."""
    meta: dict[str, object] = {
        "sources": sources,
        "method": frf.method,
        "band_hz": [float(frf.frequency_hz[0]), float(frf.frequency_hz[-1])],
        "verdict": judgement.verdict,
    }
    if judgement.verdict == "linear":
        meta |= {
            "dead_time_standard_error_s": fit.delay_error_s,
            "standard_errors": _standard_errors(fit),
        }
    else:
        meta["warning"] = "; ".join(judgement.warnings)
    if chain is not None and chain.best.model.kind == "three_inertia":
        meta["chain"] = dict(chain.best.model.parameters)
    return meta


def _standard_errors(fit: Fit) -> dict[str, list[float]]:
    numerators, denominator = fit.coefficient_errors()
    errors = {"denominator": [float(e) for e in denominator]}
    for name, row, two in zip(fit.outputs, numerators, fit.modes.structure.roll_off, strict=True):
        errors[name] = [float(e) for e in row[two - 1 :]]
    return errors


def physical_of(
    chain: ChainChoice, doubt: str, judgement: Judgement, sources: list[str], band_hz: object
) -> Model:
    """The chain that is taken, as a model."""
    best = chain.best
    meta: dict[str, object] = {
        "sources": sources,
        "band_hz": band_hz,
        "reason": chain.reason,
        "explains_the_data": not doubt,
        "verdict": judgement.verdict,
        "misfit": {name: {"gain_db": m.gain_db, "phase_deg": m.phase_deg} for name, m in best.misfit.items()},
    }
    if judgement.verdict == "linear" and not doubt:
        meta["standard_errors"] = best.standard_errors
    else:
        meta["warning"] = "; ".join(filter(None, (*judgement.warnings, doubt)))
    return Model(best.model.kind, dict(best.model.parameters), meta=meta)
