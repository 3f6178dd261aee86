"""What `hil design` writes: figures, `design.json` and the text for people."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from hil.analysis.control_design import Design, measured_loop
from hil.analysis.frequency_response import FrequencyResponse
from hil.core.controller import controller_to_toml
from hil.core.files.toml_file import FORMAT
from reports import drawings as figures


def output_files(found: Design, measured: FrequencyResponse | None) -> dict[str, bytes]:
    """Names and contents of everything but `design.json`."""
    files = {"controller.toml": controller_to_toml(found.controller).encode()}
    loops = {loop.name: loop.sampled for loop in found.loops}
    resonance = found.plant.resonance_hz
    points = None if measured is None else measured_loop(found, measured)
    at = None if measured is None else measured.frequency_hz
    chosen = found.loop(found.chosen)
    here = np.interp(resonance, found.frequency_hz, chosen.sampled)
    star = (float(np.degrees(np.angle(here))), chosen.margins.sensitivity_peak)
    pictures = {
        "nyquist": figures.nyquist(found.frequency_hz, loops, resonance, measured_hz=at, measured=points),
        "sensitivity": figures.sensitivity(
            found.frequency_hz, loops, resonance, measured_hz=at, measured=points
        ),
        "trade_off": figures.trade_off_chart(
            found.trade_off,
            chosen=star,
            chosen_name="this lead" if found.chosen == "phase" else "this notch",
        ),
    }
    for name, figure in pictures.items():
        files |= {f"{name}.{kind}": content for kind, content in figures.render(figure).items()}
    return files


def summary_of(found: Design, paper: Design | None, model: str, files: list[str]) -> dict[str, Any]:
    """The content of `design.json`."""
    controller = found.controller
    summary = {
        "format": FORMAT,
        "model": model,
        "controller": "controller.toml",
        "stabilisation": found.chosen,
        "proportional_gain": controller.wsc.proportional_gain,
        "integral_gain": controller.wsc.integral_gain,
        "pole_rad_s": found.spec.pole_rad_s,
        "inertia_kg_m2": found.spec.inertia_kg_m2 or found.plant.inertia_kg_m2,
        "lead": None
        if controller.wsc.lead is None
        else controller.wsc.lead.model_dump()
        | {"angle_deg": found.spec.lead_deg, "frequency_hz": found.spec.lead_hz},
        "notch": None if controller.wsc.notch is None else controller.wsc.notch.model_dump(),
        "resonance_hz": found.plant.resonance_hz,
        "dead_time_s": found.plant.delay_s,
        "loops": {loop.name: _loop(found, loop.name) for loop in found.loops},
        "robustness": asdict(found.robustness),
        "optimum": None if found.optimum is None else asdict(found.optimum),
        "trade_off": asdict(found.trade_off),
        "discrete_filters": {
            name: {"b": f.b, "a": f.a, "sample_time_s": f.sample_time_s, "powers": "ascending in z^-1"}
            for name, f in found.discrete.items()
        },
        "warnings": list(found.warnings),
        "notes": list(found.notes),
        "files": files,
    }
    if paper is not None:
        summary["paper_lead_36_deg_40_hz"] = _loop(paper, "phase")
    return summary


def _loop(found: Design, name: str) -> dict[str, Any]:
    loop = found.loop(name)
    here = np.interp(found.plant.resonance_hz, found.frequency_hz, loop.sampled)
    return {
        "sampled": asdict(loop.margins),
        "continuous": asdict(loop.continuous_margins),
        "at_resonance": {
            "gain_db": 20 * np.log10(abs(here)),
            "phase_deg": np.degrees(np.angle(here)),
            "sensitivity_db": -20 * np.log10(abs(1 + here)),
        },
    }


def _delay(margin_s: float) -> str:
    """In ms; far beyond what any dead time of a driveline is, digits say nothing."""
    return "> 1000" if margin_s > 1.0 else f"{margin_s * 1e3:.1f}"


def text_of(found: Design, paper: Design | None, out: Path) -> str:
    """What a person reads: warnings first, then gains, margins of every loop, the worst case, notes."""
    wsc = found.controller.wsc
    lines = [f"WARNING: {warning}" for warning in found.warnings]
    lines += [
        f"K_p {wsc.proportional_gain:.4f} N m s/rad, K_i {wsc.integral_gain:.4f} N m/rad "
        f"(p {found.spec.pole_rad_s:.3g} rad/s), resonance {found.plant.resonance_hz:.2f} Hz, "
        f"dead time {found.plant.delay_s * 1e3:.2f} ms"
    ]
    if wsc.lead is not None:
        lines.append(
            f"lead {found.spec.lead_deg:.1f}° at {found.spec.lead_hz:.1f} Hz (α {wsc.lead.alpha:.5f}, "
            f"T {wsc.lead.time_constant_s * 1e3:.4f} ms), gain one at "
            f"{wsc.lead.normalisation.replace('_', ' ')}"
        )
    lines += ["", "loop          |S|max      at Hz  max 8-20 Hz  gain dB  phase °  delay ms  stable"]
    rows = [(loop.name, loop.margins) for loop in found.loops[1:]]
    if paper is not None:
        rows.append(("36° at 40 Hz", paper.loop("phase").margins))
    for name, m in rows:
        lines.append(
            f"{name:<13}{m.sensitivity_peak:>7.2f}  {m.sensitivity_peak_hz:>9.1f}  {m.comfort_peak:>11.3f}  "
            f"{m.gain_margin_db:>7.1f}  {m.phase_margin_deg:>7.1f}  {_delay(m.delay_margin_s):>8}  "
            f"{'yes' if m.stable else 'NO'}{'  <- chosen' if name == found.chosen else ''}"
        )
    lines.append(
        "gain, phase, delay: how much each alone may grow until the loop is unstable; |S| = |1/(1 + L)|"
    )
    r = found.robustness
    lines.append(
        f"worst of {r.source}: |S|max {r.sensitivity_peak:.2f}, max 8-20 Hz {r.comfort_peak:.3f}, "
        f"{r.gain_margin_db:.1f} dB, {r.phase_margin_deg:.1f}°, stable {r.stable_share:.0%}"
    )
    lines += [f"note: {note}" for note in found.notes]
    lines += ["", f"written to {out}: controller.toml, design.json, report.html, report.pdf, figures"]
    return "\n".join(lines)
