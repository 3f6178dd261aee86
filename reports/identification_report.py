"""The report of `hil identify`: what was found, how sure it is, from which experiments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hil.analysis.identification import (
    LARGEST_DISTORTION,
    LARGEST_EXCESS,
    LARGEST_MISFIT,
    LEAST_COHERENCE,
    Identification,
)
from hil.core.model import parameter_unit
from reports import labels
from reports.figure import Figure
from reports.labels import channel_label, parameter_title, with_titles
from reports.origin import Origin
from reports.parts import Page, Part, Table, paired
from reports.response_figures import (
    ModelResponse,
    coherence_figure,
    gain_figure,
    phase_figure,
    residual_figure,
)

_POINTS = 600


def identification_page(
    found: Identification, summary: Mapping[str, Any], title: str, origin: Origin
) -> Page:
    """The page; `summary` is the content of `identification.json`."""
    linear = found.verdict == "linear"
    models = _models(found)
    delay = labels.quantity(found.fit.modes.delay_s * 1e3, "ms")
    error = f" ± {labels.number(found.fit.delay_error_s * 1e3, significant=2)}" if linear else ""
    resonance = summary["resonance_hz"]
    at = f", resonance at {labels.quantity(resonance, 'Hz')}" if resonance else ""
    return Page(
        kind="Identification of a driveline",
        title=title,
        headline=_headline(found),
        tone="error" if not linear else "quiet" if found.judgement.unseen else "pass",
        lead=f"Order {summary['order']}, dead time {delay}{error}{at}.",
        notes=tuple(with_titles(note) for note in (*found.warnings, *found.notes)),
        parts=(
            Part("responses", "Frequency responses", _method(summary), figures=_figures(found, models)),
            Part("residuals", "Residuals", _RESIDUALS, figures=_residuals(found, models)),
            Part("poles", "Poles", _POLES, (_poles(summary),)),
            Part("order", "Order", _ORDER, (_orders(summary),)),
            Part("functions", "Transfer functions", _FUNCTIONS, (_functions(summary, linear=linear),)),
            Part("chain", "Driveline chain", summary["chain_reason"], _chain(summary)),
            Part("experiments", "Experiments", "", (_experiments(summary),)),
            origin.part,
        ),
        mark=origin.mark,
        first=_first(found, summary, models),
    )


_ORDER = (
    "Held-out error: of the fit on the frequencies left out of it. Beyond noise: what is left, relative to "
    "the response, that noise alone does not explain. Whiteness: chance that the residuals have no pattern."
)
_RESIDUALS = (
    "Distance of the measured response from each model, in percent of the model. Points above the standard "
    "deviation of the measurement over a range of frequencies are misfit of the model."
)
_POLES = "Poles of the transfer functions; of a complex pair one line."
_FUNCTIONS = "Coefficients of s, the highest power first; one denominator and one dead time for all outputs."


def _method(summary: Mapping[str, Any]) -> str:
    response = summary["frequency_response"]
    low, high = (labels.number(response[key], significant=3) for key in ("from_hz", "to_hz"))
    holds = {round(e["input_hold_s"], 6) for e in summary["experiments"]}  # sample times differ by rounding
    hold = " and ".join(labels.quantity(h * 1e3, "ms", significant=3) for h in sorted(holds))
    return (
        f"{response['points']} frequencies from {low} to {high} Hz by the {response['method']} method. "
        f"Dead time excludes the {hold} zero-order hold of the input."
    )


def _headline(found: Identification) -> str:
    if found.verdict != "linear":
        return "Doubtful: no standard errors"
    if found.judgement.unseen:
        return "Linear, but part of 8-20 Hz was hardly excited: no standard errors there"
    return "Linear: standard errors hold"


def _models(found: Identification) -> tuple[ModelResponse, ...]:
    """The rational fit, and the chain where there is one."""
    frequency = np.geomspace(found.frf.frequency_hz[0], found.frf.frequency_hz[-1], _POINTS)
    rational = found.fit.modes.response(frequency)
    of_outputs = {output: rational[row] for row, output in enumerate(found.frf.outputs)}
    models = [ModelResponse(f"order {found.orders.best.order}", frequency, of_outputs)]
    if found.chain is not None:
        best = found.chain.best
        chain = best.response(frequency)
        of_outputs = {output: chain[best.outputs.index(output)] for output in found.frf.outputs}
        models.append(ModelResponse(f"{best.model.kind.replace('_', ' ')} chain", frequency, of_outputs))
    return tuple(models)


def _figures(found: Identification, models: tuple[ModelResponse, ...]) -> tuple[Figure, ...]:
    drawn = [draw(found.frf, o, models) for o in found.frf.outputs for draw in (gain_figure, phase_figure)]
    return paired((*drawn, coherence_figure(found.frf, LEAST_COHERENCE)))


def _residuals(found: Identification, models: tuple[ModelResponse, ...]) -> tuple[Figure, ...]:
    return paired(residual_figure(found.frf, output, models) for output in found.frf.outputs)


def _first(found: Identification, summary: Mapping[str, Any], models: tuple[ModelResponse, ...]) -> Part:
    """What the verdict rests on, each with its limit, and the response that is explained worst."""
    judged = found.judgement
    worst = max(judged.misfit, key=lambda output: judged.misfit[output])
    excess = found.orders.best.excess
    rows = [
        (f"Misfit beyond noise, {_of(o)}", *_judged(value, LARGEST_MISFIT, percent=True))
        for o, value in judged.misfit.items()
    ]
    rows.append(("Held-out error beyond noise", *_judged(excess, LARGEST_EXCESS, percent=True)))
    distortion = summary["quality"]["distortion"] or {}
    rows += [
        (f"Nonlinear distortion, {_of(o)}", *_judged(value, LARGEST_DISTORTION, percent=True))
        for o, value in distortion.items()
        if value is not None
    ]
    coherence = summary["frequency_response"]["median_coherence"] if judged.distortion is None else {}
    rows += [
        (f"Median coherence, {_of(o)}", *_judged(value, LEAST_COHERENCE, percent=False))
        for o, value in coherence.items()
    ]
    table = Table(("criterion", "value", "limit", "verdict"), tuple(rows), 1, 3)
    return Part(
        "quality",
        "Quality of the model",
        "",
        (table,),
        figures=paired([gain_figure(found.frf, worst, models)]),
    )


def _of(output: str) -> str:
    return channel_label(output).text.lower()


def _judged(value: float, limit: float, *, percent: bool) -> tuple[str, str, str]:
    """Value, limit and verdict: a share that may not be exceeded, else a number that must be reached."""
    if percent:
        return labels.share(value, 2, digits=3), f"≤ {labels.share(limit, 0)}", _word(value <= limit)
    return labels.number(value, 4), f"≥ {labels.nominal(limit)}", _word(value >= limit)


def _word(met: bool) -> str:
    return "met" if met else "not met"


def _poles(summary: Mapping[str, Any]) -> Table:
    """Real poles and the upper one of each pair."""
    rows = []
    for pole in summary["poles_rad_s"]:
        value = complex(pole["real"], pole["imag"])
        if value.imag < 0:
            continue
        size = abs(value)
        rows.append(
            (
                "pair" if value.imag else "integrator" if not size else "real",
                labels.number(value.real),
                f"±{labels.THIN}{labels.number(value.imag)}" if value.imag else labels.number(0.0),
                labels.number(size / (2 * np.pi)) if size else labels.DASH,
                labels.number(-value.real / size, 3) if size else labels.DASH,
            )
        )
    head = ("pole", "real part, rad/s", "imaginary part, rad/s", "natural frequency, Hz", "damping ratio")
    return Table(head, tuple(rows))


def _orders(summary: Mapping[str, Any]) -> Table:
    rows = tuple(
        (
            f"{c['order']}{'' if c['integrator'] else ', no pole at 0'}",
            labels.number(c["held_out"]),
            labels.quantity(100 * c["relative_excess"], "%", significant=3),
            labels.number(c["whiteness"], significant=2),
            labels.quantity(c["dead_time_s"] * 1e3, "ms"),
            "chosen" if c["chosen"] else "",
        )
        for c in summary["orders"]
    )
    return Table(("order", "held-out error", "beyond noise", "whiteness", "dead time", ""), rows, 1, 5)


def _functions(summary: Mapping[str, Any], *, linear: bool) -> Table:
    polynomials = [("denominator", summary["denominator"])]
    polynomials += [(channel_label(name).text, value) for name, value in summary["numerators"].items()]
    rows = []
    for name, polynomial in polynomials:
        values = polynomial["values"]
        errors = polynomial["standard_errors"] if linear else [None] * len(values)
        for place, (value, error) in enumerate(zip(values, errors, strict=True)):
            shown = labels.number(error, significant=2) if error is not None else labels.DASH
            power = f"s^{len(values) - 1 - place}"
            rows.append((name if place == 0 else "", power, labels.number(value), shown))
    return Table(("polynomial", "power", "coefficient", "standard error"), tuple(rows), 2)


def _chain(summary: Mapping[str, Any]) -> tuple[Table, ...]:
    """Misfit of every chain, and the parameters of the one that was taken."""
    if not summary["chains"]:
        return ()
    outputs = tuple(summary["chains"][0]["misfit"])
    misfits = tuple(
        (
            one["kind"].replace("_", " "),
            *(
                f"{labels.number(m['gain_db'], 2)} dB, {labels.number(m['phase_deg'], 1)}°"
                for m in one["misfit"].values()
            ),
            "chosen" if one["chosen"] else "",
        )
        for one in summary["chains"]
    )
    heads = tuple(channel_label(output).text for output in outputs)
    tables = [Table(("chain", *heads, ""), misfits, 1, 1 + len(heads))]
    for one in summary["chains"]:
        if one["chosen"]:
            errors = one["standard_errors"] or {}
            rows = tuple(
                (
                    parameter_title(name),
                    labels.number(value),
                    _error(errors.get(name)),
                    parameter_unit(name),
                )
                for name, value in one["parameters"].items()
            )
            tables.append(Table(("parameter", "value", "standard error", "unit"), rows, 1, 3))
    return tuple(tables)


def _error(value: float | None) -> str:
    return labels.DASH if value is None else labels.number(value, significant=2)


def _experiments(summary: Mapping[str, Any]) -> Table:
    rows = tuple(
        (
            e["name"].rpartition("/")[2],
            e["kind"],
            labels.quantity(e["duration_s"], "s", 1),
            labels.quantity(e["input_hold_s"] * 1e3, "ms", significant=3),
        )
        for e in summary["experiments"]
    )
    return Table(("experiment", "kind", "length", "hold of the input"), rows, 2)
