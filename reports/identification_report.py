"""The report of `hil identify`: what was found, how sure it is, from which experiments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hil.analysis.identification import Identification
from hil.core.model import parameter_unit
from reports import quantities
from reports.drawings import Drawing
from reports.labels import Label, channel_label
from reports.origin import Origin
from reports.parts import Page, Part, Table


def identification_page(
    found: Identification, summary: Mapping[str, Any], files: Mapping[str, bytes], title: str, origin: Origin
) -> Page:
    """The page; `summary` is the content of `identification.json`, `files` hold the figures."""
    linear = found.verdict == "linear"
    delay = quantities.quantity(found.fit.modes.delay_s * 1e3, "ms")
    error = f" ± {quantities.number(found.fit.delay_error_s * 1e3, significant=2)}" if linear else ""
    resonance = summary["resonance_hz"]
    at = f", resonance at {quantities.quantity(resonance, 'Hz')}" if resonance else ""
    return Page(
        kind="Identification of a driveline",
        title=title,
        headline="Linear: standard errors hold" if linear else "Doubtful: no standard errors",
        tone="pass" if linear else "error",
        lead=f"Order {summary['order']}, dead time {delay}{error}{at}.",
        notes=(*found.warnings, *found.notes),
        parts=(
            Part("responses", "Frequency responses", _method(summary), figures=_figures(found, files)),
            Part("order", "Order", _ORDER, (_orders(summary),)),
            Part("functions", "Transfer functions", _FUNCTIONS, (_functions(summary, linear=linear),)),
            Part("chain", "Driveline chain", summary["chain_reason"], _chain(summary)),
            Part("experiments", "Experiments", "", (_experiments(summary),)),
            origin.part,
        ),
        mark=origin.mark,
    )


_ORDER = (
    "Held-out error: of the fit on the frequencies left out of it. Beyond noise: what is left, relative to "
    "the response, that noise alone does not explain. Whiteness: chance that the residuals have no pattern."
)
_FUNCTIONS = "Coefficients of s, the highest power first; one denominator and one dead time for all outputs."


def _method(summary: Mapping[str, Any]) -> str:
    response = summary["frequency_response"]
    low, high = (quantities.number(response[key], significant=3) for key in ("from_hz", "to_hz"))
    holds = {e["input_hold_s"] for e in summary["experiments"]}
    hold = " and ".join(quantities.quantity(h * 1e3, "ms", significant=3) for h in sorted(holds))
    return (
        f"{response['points']} frequencies from {low} to {high} Hz by the {response['method']} method. The "
        f"input's hold of {hold} is taken out: dead time stands beside it, not in it."
    )


def _figures(found: Identification, files: Mapping[str, bytes]) -> tuple[Drawing, ...]:
    drawn = []
    for output in found.frf.outputs:
        label = channel_label(output)
        words = (
            f"Bode diagram: {label.text.lower()} over motor torque, measured with its 95 % band, and fits."
        )
        drawn.append(Drawing(Label(label.text, label.symbol), files[f"bode_{output}.svg"], words))
    words = "Coherence of every output over frequency, and the relative standard deviation of its response."
    return (*drawn, Drawing(Label("Coherence"), files["coherence.svg"], words))


def _orders(summary: Mapping[str, Any]) -> Table:
    rows = tuple(
        (
            f"{c['order']}{'' if c['integrator'] else ', no pole at 0'}",
            quantities.number(c["held_out"]),
            quantities.quantity(100 * c["relative_excess"], "%", significant=3),
            quantities.number(c["whiteness"], significant=2),
            quantities.quantity(c["dead_time_s"] * 1e3, "ms"),
            "taken" if c["chosen"] else "",
        )
        for c in summary["orders"]
    )
    return Table(("order", "held-out error", "beyond noise", "whiteness", "dead time", "choice"), rows, 1, 5)


def _functions(summary: Mapping[str, Any], *, linear: bool) -> Table:
    polynomials = [("denominator", summary["denominator"])]
    polynomials += [(channel_label(name).text, value) for name, value in summary["numerators"].items()]
    rows = []
    for name, polynomial in polynomials:
        values = polynomial["values"]
        errors = polynomial["standard_errors"] if linear else [None] * len(values)
        for place, (value, error) in enumerate(zip(values, errors, strict=True)):
            told = quantities.number(error, significant=2) if error is not None else quantities.DASH
            power = f"s^{len(values) - 1 - place}"
            rows.append((name if place == 0 else "", power, quantities.number(value), told))
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
                f"{quantities.number(m['gain_db'], 2)} dB, {quantities.number(m['phase_deg'], 1)}°"
                for m in one["misfit"].values()
            ),
            "taken" if one["chosen"] else "",
        )
        for one in summary["chains"]
    )
    heads = tuple(channel_label(output).text for output in outputs)
    tables = [Table(("chain", *heads, "choice"), misfits, 1, 1 + len(heads))]
    for one in summary["chains"]:
        if one["chosen"]:
            errors = one["standard_errors"] or {}
            rows = tuple(
                (name, quantities.number(value), _error(errors.get(name)), parameter_unit(name))
                for name, value in one["parameters"].items()
            )
            tables.append(Table(("parameter", "value", "standard error", "unit"), rows, 1, 3))
    return tuple(tables)


def _error(value: float | None) -> str:
    return quantities.DASH if value is None else quantities.number(value, significant=2)


def _experiments(summary: Mapping[str, Any]) -> Table:
    rows = tuple(
        (
            e["name"].rpartition("/")[2],
            e["kind"],
            quantities.quantity(e["duration_s"], "s", 1),
            quantities.quantity(e["input_hold_s"] * 1e3, "ms", significant=3),
        )
        for e in summary["experiments"]
    )
    return Table(("experiment", "kind", "length", "hold of the input"), rows, 2)
