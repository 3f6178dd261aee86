"""The report of a diagnosis, as HTML and PDF/A: the gap before and after, what was named and why.

Both forms are made from one list of sections, each with tables, maps (shaded tables) and figures.
"""

from __future__ import annotations

import base64
import json
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import signal

from hil.analysis.diagnosis import BANDS_HZ, CONDITIONS, Diagnosis, GapMap, NamedEffect, Overlay
from hil.core.channels import CHANNELS, OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import parameter_unit
from reports import quantities, style
from reports.figure import Figure, Trace
from reports.labels import Label
from reports.pdf import _font_directory, _known_characters, _spelled_out
from reports.svg_figure import svg_figure

Array = npt.NDArray[np.float64]

_HEADLINES = {
    "named": "Named: {names}",
    "none": "The model explains the data to the noise",
    "unknown": "A gap that no known effect closes",
}
_TONES = {"named": "pass", "none": "pass", "unknown": "error"}
_WINDOW_S = 1.5
_MOST_CONSIDERED = 20


@dataclass(frozen=True)
class Table:
    """Rows of text under a head; columns from `numbers_from` on are numbers."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers_from: int = 1


@dataclass(frozen=True)
class Cell:
    """One field of a map: its text, and how dark it is from 0 (noise) to 1."""

    text: str
    shade: float


@dataclass(frozen=True)
class Map:
    """A shaded table."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Cell, ...]], ...]


@dataclass(frozen=True)
class Part:
    """A section of the report."""

    id: str
    title: str
    text: str
    tables: tuple[Table, ...] = ()
    maps: tuple[Map, ...] = ()
    figures: tuple[Figure, ...] = ()


def diagnosis_html(found: Diagnosis, title: str) -> str:
    """The page: one file without scripts, figures drawn into it."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("reports"),
        autoescape=True,
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template("diagnosis.html.j2").render(
        title=title,
        headline=_headline(found),
        tone=_TONES[found.verdict],
        lead=_lead(found),
        notes=found.notes,
        parts=[_with_pictures(part) for part in _parts(found)],
        light=style.css_variables("light"),
        dark=style.css_variables("dark"),
        css=resources.files("reports").joinpath("templates/report.css").read_text(encoding="utf-8"),
    )


def diagnosis_pdf(found: Diagnosis, title: str) -> bytes:
    """The same on paper: PDF/A-2b. Every text reaches Typst as data."""
    import typst

    data: dict[str, Any] = {
        "title": title,
        "headline": _headline(found),
        "tone": _TONES[found.verdict],
        "lead": _lead(found),
        "notes": list(found.notes),
        "parts": [_as_data(part) for part in _parts(found)],
        "colors": {name: tone.light for name, tone in style.SURFACE.items()},
    }
    data = _spelled_out(data, _known_characters())
    pdf = typst.compile(  # type: ignore[misc]
        resources.files("reports").joinpath("templates/diagnosis.typ").read_bytes(),
        font_paths=[_font_directory()],
        ignore_system_fonts=True,
        sys_inputs={"report": json.dumps(data, ensure_ascii=False)},
        pdf_standards=["a-2b"],
    )
    return bytes(pdf)


def _headline(found: Diagnosis) -> str:
    names = ", ".join(EFFECTS[e.use.id].title.lower() for e in found.effects)
    return _HEADLINES[found.verdict].format(names=names)


def _lead(found: Diagnosis) -> str:
    if found.verdict == "unknown":
        return f"What is known of it: {found.signature}."
    worst = max(
        ((name, g.gap / max(g.noise_floor, 1e-12)) for name, g in found.gap_after.items()), key=lambda p: p[1]
    )
    return (
        f"With the model given back, the gap is at most {worst[1]:.2f} times the noise ({_short(worst[0])})."
    )


def _short(channel: str) -> str:
    return CHANNELS[channel].meaning if channel in CHANNELS else channel


def _parts(found: Diagnosis) -> list[Part]:
    return [
        Part("effects", "Effects named", _effects_text(found), (_effects(found),) if found.effects else ()),
        Part(
            "gap",
            "Gap per channel",
            "Rms of measured minus simulated over rms of the measured channel around its mean. The noise "
            "floor is the same ratio for the noise, estimated from the spectrum above all modes.",
            tuple(_gaps(found)),
        ),
        Part(
            "map",
            "Where the gap is",
            "Error over noise, 1 is noise alone: by recording and frequency band, and by condition.",
            maps=tuple(_maps(found)),
        ),
        *_overlays(found),
        Part(
            "parameters",
            "Parameters of the model",
            "",
            (_parameters(found),) if found.parameter_updates else (),
        ),
        Part(
            "consequences",
            "What it does to the acceptance figures",
            "Open-loop step of 20 N m, model before and after.",
            (_consequences(found),),
        ),
        Part(
            "considered",
            "Considered and not named",
            "Expected drop: of the squared error in noise variances, by the linearised score.",
            (_considered(found),) if found.considered else (),
        ),
        Part(
            "alternatives",
            "Other names for the same gap",
            "",
            (_alternatives(found),) if found.alternatives else (),
        ),
    ]


def _effects_text(found: Diagnosis) -> str:
    if not found.effects:
        return "None."
    return " ".join(f"{EFFECTS[e.use.id].summary} {EFFECTS[e.use.id].signature}" for e in found.effects)


def _effects(found: Diagnosis) -> Table:
    rows = []
    for e in found.effects:
        units = {p.name: p.unit for p in EFFECTS[e.use.id].parameters}
        for index, (name, value) in enumerate(e.use.values.items()):
            shown = value if isinstance(value, str) else quantities.quantity(value, units.get(name, ""))
            error = e.standard_error.get(name)
            rows.append(
                (
                    EFFECTS[e.use.id].title if index == 0 else "",
                    name,
                    shown,
                    quantities.number(error) if error is not None else "",
                    f"{e.confidence:.0%}" if index == 0 else "",
                    _place(e) if index == 0 else "",
                )
            )
    return Table(("effect", "parameter", "value", "standard error", "confidence", "where"), tuple(rows), 2)


def _place(effect: NamedEffect) -> str:
    low, high = effect.where.band_hz
    return f"{', '.join(effect.where.channels)}; {low:g}-{high:g} Hz; {effect.where.condition}"


def _gaps(found: Diagnosis) -> list[Table]:
    tables = []
    pairs = (("fitted recordings", found.gap_before, found.gap_after),)
    held = (
        (("held-out recordings", found.holdout_before, found.holdout_after),) if found.holdout_after else ()
    )
    for name, before, after in (*pairs, *held):
        rows = tuple(
            (
                c,
                quantities.number(before[c].gap),
                quantities.number(after[c].gap),
                quantities.number(after[c].noise_floor),
                f"{after[c].gap / max(after[c].noise_floor, 1e-12):.3f}",
            )
            for c in after
        )
        tables.append(Table((name, "before", "after", "noise floor", "after / noise"), rows))
    return tables


def _maps(found: Diagnosis) -> list[Map]:
    bands = tuple(f"{low:g}-{high:g} Hz" for low, high in BANDS_HZ)
    maps = []
    for when, gaps in (("before", found.map_before), ("after", found.map_after)):
        for column, channel in enumerate(OUTPUTS):
            if np.isfinite(gaps.by_band[:, column]).any():
                rows = tuple(
                    (name, tuple(_cell(v) for v in gaps.by_band[row, column]))
                    for row, name in enumerate(gaps.recordings)
                )
                maps.append(Map(f"{channel}, {when}", ("recording", *bands), rows))
    maps.append(_conditions("before", found.map_before))
    maps.append(_conditions("after", found.map_after))
    return maps


def _conditions(when: str, gaps: GapMap) -> Map:
    rows = tuple(
        (channel, tuple(_cell(v) for v in gaps.by_condition[:, column]))
        for column, channel in enumerate(OUTPUTS)
    )
    return Map(f"operating conditions, {when}", ("channel", *CONDITIONS), rows)


def _cell(ratio: float) -> Cell:
    if not np.isfinite(ratio):
        return Cell("–", 0.0)
    shade = float(np.clip(np.log(max(ratio, 1.0)) / np.log(30.0), 0.0, 1.0))
    return Cell(f"{ratio:.3g}" if ratio < 1000 else f"{ratio:.0f}", round(shade, 3))


def _overlays(found: Diagnosis) -> list[Part]:
    figures = []
    best = max(found.overlays, key=lambda o: _worst(o))
    for column, channel in enumerate(OUTPUTS):
        if np.isfinite(best.measured[0, column]):
            figures += [_in_time(best, column, channel), _in_frequency(best, column, channel)]
    text = f"Recording {best.name}, where the gap was largest: {_WINDOW_S:g} s at its worst moment, and the "
    return [
        Part("overlays", "Measured and simulated", text + "spectra of the errors.", figures=tuple(figures))
    ]


def _worst(overlay: Overlay) -> float:
    change = np.nanmean((overlay.after - overlay.before) ** 2, axis=0)
    spread = np.nanvar(overlay.measured, axis=0) + 1e-12
    return float(np.nanmax(change / spread)) if np.isfinite(change).any() else 0.0


def _in_time(o: Overlay, column: int, channel: str) -> Figure:
    size = max(10, round(_WINDOW_S / o.dt))
    power = np.convolve((o.measured[:, column] - o.before[:, column]) ** 2, np.ones(size), "valid")
    first = int(np.argmax(power))
    window = slice(first, first + size)
    t = np.asarray(np.arange(first, first + size) * o.dt, dtype=float)
    traces = (
        Trace(Label("measured"), t, o.measured[window, column], "reference"),
        Trace(Label("model before"), t, o.before[window, column], "phase", "dash"),
        Trace(Label("model after"), t, o.after[window, column], "gain"),
    )
    unit = CHANNELS[channel].unit
    return Figure(f"time-{channel}", Label(channel), "Time", "s", Label(channel), unit, traces)


def _in_frequency(o: Overlay, column: int, channel: str) -> Figure:
    traces = []
    for name, simulated, role in (("error before", o.before, "phase"), ("error after", o.after, "gain")):
        error = o.measured[:, column] - simulated[:, column]
        f, density = signal.welch(error, 1 / o.dt, nperseg=min(4096, len(error)))
        inside = (f > 0.2) & (f < 100.0)
        traces.append(Trace(Label(name), f[inside], np.sqrt(density[inside]), role))
    unit = f"{CHANNELS[channel].unit}/√Hz"
    title = Label(f"{channel}, spectrum of the error")
    return Figure(
        f"spectrum-{channel}", title, "Frequency", "Hz", Label("error"), unit, tuple(traces), logarithmic=True
    )


def _parameters(found: Diagnosis) -> Table:
    rows = tuple(
        (
            name,
            quantities.number(old),
            quantities.number(new),
            quantities.number(error, significant=2),
            f"{new / old - 1.0:+.2%}",
            parameter_unit(name),
        )
        for name, (old, new, error) in found.parameter_updates.items()
    )
    return Table(("parameter", "from", "to", "standard error", "change", "unit"), rows)


def _consequences(found: Diagnosis) -> Table:
    rows = tuple(
        (name, quantities.number(v["before"]), quantities.number(v["after"]))
        for name, v in found.consequences.items()
    )
    return Table(("figure", "before", "after"), rows)


def _considered(found: Diagnosis) -> Table:
    rows = tuple(
        (
            c.id + (f" ({c.about})" if c.about else ""),
            quantities.number(c.score, 0),
            f"{c.left:.3g}" if c.left is not None else "–",
            c.reason,
        )
        for c in found.considered[:_MOST_CONSIDERED]
    )
    return Table(("effect", "expected drop", "gap left / noise", "why not"), rows)


def _alternatives(found: Diagnosis) -> Table:
    rows = tuple(
        (a.use.id, f"{a.confidence:.1%}", a.separating_test, a.plan or "") for a in found.alternatives
    )
    return Table(("effect", "confidence", "separating test", "plan"), rows)


def _with_pictures(part: Part) -> dict[str, Any]:
    data = _as_data(part)
    for figure in data["figures"]:
        figure["uri"] = "data:image/svg+xml;base64," + base64.b64encode(figure["svg"].encode()).decode()
    return data


def _as_data(part: Part) -> dict[str, Any]:
    return {
        "id": part.id,
        "title": part.title,
        "text": part.text,
        "tables": [asdict(t) for t in part.tables],
        "maps": [asdict(m) for m in part.maps],
        "figures": [
            {"svg": svg_figure(f).decode(), "title": f.title.plain(), "alt": f.alternative_text()}
            for f in part.figures
        ],
    }
