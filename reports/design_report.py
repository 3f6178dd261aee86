"""The report of `hil design`: the controller, its margins, the figures behind them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hil.analysis.control_design import (
    LARGEST_SENSITIVITY,
    LEAST_GAIN_MARGIN_DB,
    LEAST_PHASE_MARGIN_DEG,
    Design,
)
from hil.core.channels import COMFORT_BAND_HZ
from reports import labels
from reports.drawings import Drawing
from reports.figure import Band, Figure, Level, Trace
from reports.labels import Label
from reports.origin import Origin
from reports.parts import Page, Part, Table

_LOOPS = {"plant": "plant alone", "pi": "PI", "phase": "PI and lead", "gain": "PI and notch"}
_FIGURES = {
    "nyquist": ("Open loops", "Nyquist diagram of the plant alone, with PI, with PI and lead, PI and notch."),
    "sensitivity": ("Sensitivity", "|S| in decibels over frequency for the controlled loops."),
    "trade_off": ("Trade-off of the phase lead", "Phase at the resonance against the sensitivity peak."),
}


def design_page(
    found: Design, summary: Mapping[str, Any], files: Mapping[str, bytes], title: str, origin: Origin
) -> Page:
    """The page; `summary` is the content of `design.json`, `files` hold the figures."""
    chosen = found.loop(found.chosen).margins
    fine = chosen.stable and not found.warnings
    worst = found.robustness
    return Page(
        kind="Control design",
        title=title,
        headline=f"{_LOOPS[found.chosen]}: {'stable' if chosen.stable else 'NOT stable'}",
        tone="pass" if fine else "error",
        lead=f"Largest sensitivity {labels.number(chosen.sensitivity_peak, 2)} at "
        f"{labels.quantity(chosen.sensitivity_peak_hz, 'Hz', 1)}, gain margin "
        f"{labels.quantity(chosen.gain_margin_db, 'dB', 1)}, phase margin "
        f"{labels.number(chosen.phase_margin_deg, 1)}°; of {worst.source} at worst "
        f"{labels.number(worst.sensitivity_peak, 2)}.",
        notes=(*found.warnings, *found.notes),
        parts=(
            Part("controller", "Controller", "", (_controller(found, summary),)),
            Part("margins", "Margins", _MARGINS, (_margins(found), _continuous(found))),
            Part("figures", "Figures", "", figures=_figures(files)),
            origin.part,
        ),
        mark=origin.mark,
        first=_first(found),
    )


_MARGINS = (
    "Sampled: as the RMCU closes the loop, with its hold and with what sampling folds back from beyond half "
    "its rate (aliasing). Continuous: the same controller without sampling. Limits are judged by the first. "
    "|S| = |1/(1 + L)|; gain, phase and delay say by how much each alone may grow until the loop is unstable."
)


def _controller(found: Design, summary: Mapping[str, Any]) -> Table:
    wsc = found.controller.wsc
    rows = [
        ("proportional gain K_p", labels.number(wsc.proportional_gain), "N m s/rad"),
        ("integral gain K_i", labels.number(wsc.integral_gain), "N m/rad"),
        ("pole p", labels.number(found.spec.pole_rad_s), "rad/s"),
        ("inertia", labels.number(summary["inertia_kg_m2"]), "kg m²"),
        ("resonance of the plant", labels.number(summary["resonance_hz"]), "Hz"),
        ("dead time of the plant", labels.number(1e3 * summary["dead_time_s"]), "ms"),
    ]
    if wsc.lead is not None:
        rows += [
            ("lead angle", labels.number(found.spec.lead_deg), "°"),
            ("lead frequency", labels.number(found.spec.lead_hz), "Hz"),
        ]
    if summary["notch"] is not None:
        rows += [
            (f"notch, {key.replace('_', ' ')}", str(value), "") for key, value in summary["notch"].items()
        ]
    return Table(("quantity", "value", "unit"), tuple(rows), 1, 2)


def _margins(found: Design) -> Table:
    return _table("sampled", [(loop.name, loop.margins) for loop in found.loops], found.chosen)


def _continuous(found: Design) -> Table:
    rows = [(loop.name, loop.continuous_margins) for loop in found.loops]
    return _table("continuous", rows, found.chosen)


def _table(name: str, loops: list[tuple[str, Any]], chosen: str) -> Table:
    rows = tuple(
        (
            _LOOPS[loop] + (" (chosen)" if loop == chosen else ""),
            labels.number(m.sensitivity_peak, 3),
            labels.number(m.sensitivity_peak_hz, 1),
            labels.number(m.comfort_peak, 3),
            labels.number(m.gain_margin_db, 1),
            labels.number(m.phase_margin_deg, 1),
            _delay(m.delay_margin_s),
            "yes" if m.stable else "NO",
        )
        for loop, m in loops
    )
    head = (name, "|S|max", "at Hz", "max 8-20 Hz", "gain dB", "phase °", "delay ms", "stable")
    return Table(head, rows, 1, 7)


def _delay(margin_s: float) -> str:
    """In ms; far beyond what any dead time of a driveline is, digits say nothing."""
    return f">{labels.THIN}1000" if margin_s > 1.0 else labels.number(1e3 * margin_s, 1)


def _first(found: Design) -> Part:
    """The limits that a loop is accepted by, and the sensitivity over frequency."""
    m = found.loop(found.chosen).margins
    deg = labels.unit("°")
    rows = (
        _judged("Largest sensitivity |S|max", m.sensitivity_peak, LARGEST_SENSITIVITY, "", most=True),
        _judged("Gain margin", m.gain_margin_db, LEAST_GAIN_MARGIN_DB, "dB", most=False),
        _judged("Phase margin", m.phase_margin_deg, LEAST_PHASE_MARGIN_DEG, deg, most=False),
        ("Stable", "yes" if m.stable else "no", "yes", "met" if m.stable else "not met"),
    )
    table = Table(("criterion, sampled loop", "value", "limit", "verdict"), rows, 1, 3)
    return Part("summary", "Acceptance of the loop", "", (table,), figures=(_sensitivity(found),))


def _judged(name: str, value: float, limit: float, unit: str, *, most: bool) -> tuple[str, str, str, str]:
    met = value <= limit if most else value >= limit
    sign = "≤" if most else "≥"
    of_limit = f"{labels.nominal(limit)} {unit}".strip()
    return name, labels.quantity(value, unit, 2), f"{sign} {of_limit}", "met" if met else "not met"


def _sensitivity(found: Design) -> Figure:
    """|S| of every controlled loop; the limit belongs to the largest value of the chosen one."""
    roles = {"pi": "reference", "phase": "phase", "gain": "gain"}
    low, high = max(0.1, float(found.frequency_hz[0])), min(100.0, float(found.frequency_hz[-1]))
    traces = tuple(
        Trace(
            Label(_LOOPS[loop.name] + (" (chosen)" if loop.name == found.chosen else "")),
            found.frequency_hz,
            -20.0 * np.log10(np.maximum(np.abs(1.0 + loop.sampled), 1e-300)),
            roles[loop.name],
        )
        for loop in found.loops
        if loop.name in roles
    )
    limit = 20.0 * float(np.log10(LARGEST_SENSITIVITY))
    name = f"{COMFORT_BAND_HZ[0]:g}{labels.DASH}{COMFORT_BAND_HZ[1]:g}{labels.THIN}Hz"
    return Figure(
        "sensitivity",
        Label("Sensitivity of the wheel speed control"),
        "Frequency",
        "Hz",
        Label("Sensitivity |S|"),
        "dB",
        traces,
        bands=(Band(*COMFORT_BAND_HZ, name),),
        levels=(Level(limit, f"Limit |S|max {LARGEST_SENSITIVITY:g}, {_LOOPS[found.chosen]}"),),
        x_range=(low, high),
        logarithmic_x=True,
        wide=True,
    )


def _figures(files: Mapping[str, bytes]) -> tuple[Drawing, ...]:
    return tuple(
        Drawing(Label(title), files[f"{name}.svg"], words) for name, (title, words) in _FIGURES.items()
    )
