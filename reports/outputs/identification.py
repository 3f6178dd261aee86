"""What `hil identify` writes: figures, `identification.json` and the text for people."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from hil.analysis.control_design import resonance_hz
from hil.analysis.frequency_response import Experiment, frf_to_csv
from hil.analysis.identification import (
    CHAINS,
    Candidate,
    Identification,
    OrderModel,
    chain_models,
    information_criterion,
    order_models,
    resonances_of,
)
from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError
from hil.core.errors.wording import share
from hil.core.files.toml_file import FORMAT
from hil.core.model import model_to_toml
from reports import drawings as figures


def output_files(found: Identification) -> dict[str, bytes]:
    """Names and contents of everything but `identification.json`."""
    files = {"frf.csv": frf_to_csv(found.frf).encode(), "model.toml": model_to_toml(found.model).encode()}
    if found.physical is not None:
        files["physical.toml"] = model_to_toml(found.physical).encode()
    files |= _other_models(found)
    resonance = _resonance(found)
    frequency = np.geomspace(found.frf.frequency_hz[0], found.frf.frequency_hz[-1], 600)
    rational = found.fit.modes.response(frequency)
    for row, output in enumerate(found.frf.outputs):
        name = f"order {found.orders.best.order}, {found.fit.modes.delay_s * 1e3:.2f} ms"
        curves = [figures.Curve(name, frequency, rational[row])]
        if found.chain is not None:
            chain = found.chain.best.response(frequency)[found.chain.best.outputs.index(output)]
            kind = found.chain.best.model.kind.replace("_", " ")
            curves.append(figures.Curve(f"{kind} chain", frequency, chain))
        picture = figures.bode(found.frf, output, tuple(curves), resonance_hz=resonance)
        files |= _pictures(f"bode_{output}", picture)
    return files | _pictures("coherence", figures.coherence(found.frf, resonance_hz=resonance))


def _other_models(found: Identification) -> dict[str, bytes]:
    """Models of the orders and chains that were not taken, by the names of their files."""
    others = {}
    for candidate, one in zip(found.orders.candidates, order_models(found), strict=True):
        if one is not None and candidate is not found.orders.best:
            others[_order_file(candidate)] = one.model
    for model in chain_models(found):
        if model is not found.physical:
            others[f"chain_{model.kind}.toml"] = model
    return {name: model_to_toml(model).encode() for name, model in others.items()}


def _order_file(candidate: Candidate) -> str:
    return f"order_{candidate.order}{'' if candidate.integrator else '_free'}.toml"


def _pictures(name: str, figure: Figure) -> dict[str, bytes]:
    return {f"{name}.{kind}": content for kind, content in figures.render(figure).items()}


def _resonance(found: Identification) -> float | None:
    """The least damped pole pair; none outside the data, where a fit may put a pole anywhere."""
    try:
        resonance = resonance_hz(found.fit.polynomials()[1])
    except BadInputError:
        return None
    return resonance if found.frf.frequency_hz[0] <= resonance <= found.frf.frequency_hz[-1] else None


def summary_of(found: Identification, experiments: list[Experiment], files: list[str]) -> dict[str, Any]:
    """The content of `identification.json`."""
    fit, frf, best = found.fit, found.frf, found.orders.best
    numerators, denominator = fit.polynomials()
    numerator_errors, denominator_errors = fit.coefficient_errors()
    poles = fit.modes.pole_locations()
    sure = found.verdict == "linear"  # misfit that is no noise makes standard errors meaningless
    return {
        "format": FORMAT,
        "verdict": found.verdict,
        "warnings": list(found.warnings),
        "quality": {
            "misfit": found.judgement.misfit,
            "distortion": found.judgement.distortion,
            "coherence": found.judgement.coherence,
            "meaning": "relative to the response, medians over frequency; misfit and distortion beyond noise",
        },
        "experiments": [
            {"name": e.name, "duration_s": e.duration_s, "kind": e.kind, "input_hold_s": e.hold_s}
            for e in experiments
        ],
        "frequency_response": {
            "method": frf.method,
            "from_hz": frf.frequency_hz[0],
            "to_hz": frf.frequency_hz[-1],
            "points": len(frf.frequency_hz),
            "median_coherence": {o: float(np.median(frf.coherence[i])) for i, o in enumerate(frf.outputs)},
        },
        "order": best.order,
        "integrator": best.integrator,
        "dead_time_s": {"value": fit.modes.delay_s, "standard_error": fit.delay_error_s if sure else None},
        "resonance_hz": _resonance(found),
        "poles_rad_s": [{"real": float(p.real), "imag": float(p.imag)} for p in poles],
        "denominator": {"values": denominator, "standard_errors": denominator_errors if sure else None},
        "numerators": {
            name: {"values": values, "standard_errors": errors if sure else None}
            for name, values, errors in zip(fit.outputs, numerators, numerator_errors, strict=True)
        },
        "chi_square": fit.chi_square,
        "orders": [
            _order(found, candidate, one)
            for candidate, one in zip(found.orders.candidates, order_models(found), strict=True)
        ],
        "chains": [] if found.chain is None else _chains(found),
        "chain": None if found.physical is None else found.physical.kind,
        "chain_reason": "" if found.chain is None else found.chain.reason,
        "distortion": _distortion(found),
        "notes": list(found.notes),
        "model": "model.toml",
        "physical": None if found.physical is None else "physical.toml",
        "files": files,
    }


def _order(found: Identification, candidate: Candidate, one: OrderModel | None) -> dict[str, Any]:
    taken, fit = candidate is found.orders.best, candidate.fit
    sure = one is not None and one.judgement.verdict == "linear"
    return {
        "order": candidate.order,
        "integrator": candidate.integrator,
        "held_out": candidate.held_out,
        "relative_excess": candidate.excess,
        "whiteness": candidate.whiteness,
        "dead_time_s": fit.modes.delay_s,
        "dead_time_error_s": fit.delay_error_s if sure else None,
        "resonances": [
            {
                "frequency_hz": pair.frequency_hz,
                "damping": pair.damping,
                "frequency_error_hz": pair.frequency_error_hz if sure else None,
                "damping_error": pair.damping_error if sure else None,
            }
            for pair in resonances_of(fit)
        ],
        "parameters": len(fit.covariance),
        "chi_square": fit.chi_square,
        "bic": information_criterion(fit),
        "verdict": one.judgement.verdict if one else "doubtful",
        "model": "model.toml" if taken else _order_file(candidate) if one else None,
        "chosen": taken,
    }


def _chains(found: Identification) -> list[dict[str, Any]]:
    assert found.chain is not None
    return [
        {
            "kind": one.model.kind,
            "explains": one.explains,
            "chosen": one is found.chain.best,
            "model": "physical.toml" if one is found.chain.best else f"chain_{one.model.kind}.toml",
            "parameters": one.model.parameters,
            "standard_errors": one.standard_errors if found.verdict == "linear" else None,
            "misfit": {
                name: {
                    "gain_db": m.gain_db,
                    "phase_deg": m.phase_deg,
                    "noise_db": m.noise_db,
                    "noise_deg": m.noise_deg,
                }
                for name, m in one.misfit.items()
            },
        }
        for one in found.chain.fits
    ]


def _distortion(found: Identification) -> dict[str, Any] | None:
    d = found.frf.distortion
    if d is None:
        return None

    def level(values: Any) -> dict[str, float | None]:
        rms = np.sqrt(np.mean(values**2, axis=1)) if values.shape[1] else np.full(len(values), np.nan)
        return dict(zip(found.frf.outputs, rms.tolist(), strict=True))

    return {
        "odd": level(d.odd),
        "odd_noise": level(d.odd_noise),
        "even": level(d.even),
        "even_noise": level(d.even_noise),
        "meaning": "rms of one line that the input leaves out, in the output's unit",
    }


def text_of(found: Identification, summary: dict[str, Any], out: Path) -> str:
    """What a person reads; a doubtful model begins with its warnings and has no standard errors."""
    frf, fit = found.frf, found.fit
    lines = [f"WARNING: {warning}" for warning in found.warnings]
    if lines:
        lines.append("The model below is doubtful. Do not design a controller from it unchecked.")
    error = f" ± {fit.delay_error_s * 1e3:.3f}" if found.verdict == "linear" else ""
    lines += [
        f"{len(summary['experiments'])} experiment(s), "
        f"{frf.frequency_hz[0]:.3g}-{frf.frequency_hz[-1]:.3g} Hz, "
        f"{len(frf.frequency_hz)} frequencies, {frf.method}",
        f"order {summary['order']}, "
        f"dead time {fit.modes.delay_s * 1e3:.3f}{error} ms beside a hold of "
        f"{summary['experiments'][0]['input_hold_s'] * 1e3:g} ms"
        + (f", resonance {summary['resonance_hz']:.2f} Hz" if summary["resonance_hz"] else ""),
        "",
        "order      held-out error  beyond noise  whiteness p",
    ]
    for c in summary["orders"]:
        kind = "" if c["integrator"] else " (no pole at 0)"
        mark = "  <- chosen" if c["chosen"] else ""
        name = f"{c['order']}{kind}"
        lines.append(
            f"{name:<18}{c['held_out']:>7.4g}  {share(c['relative_excess'], 2):>11}  "
            f"{c['whiteness']:>11.2g}{mark}"
        )
    if summary["chains"]:
        symbols = [CHANNELS[o].symbol for o in frf.outputs]
        lines += ["", f"chain          misfit in dB / degrees rms ({', '.join(symbols)})"]
        for kind, one in zip(CHAINS, summary["chains"], strict=True):
            cells = "  ".join(f"{m['gain_db']:.1f}/{m['phase_deg']:.0f}" for m in one["misfit"].values())
            lines.append(f"{kind:<15}{cells}{'  <- chosen' if one['chosen'] else ''}")
        lines.append(summary["chain_reason"])
    lines += [f"note: {note}" for note in summary["notes"]]
    lines += [
        "",
        f"written to {out}: model.toml, frf.csv, identification.json, report.html, report.pdf, figures",
    ]
    return "\n".join(lines)
