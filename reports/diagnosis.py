"""The report of a diagnosis, as HTML and PDF/A: the gap before and after, what was named and why.

Both forms are made from one list of sections (`reports.diagnosis_content`).
"""

from __future__ import annotations

import base64
import json
from dataclasses import asdict
from importlib import resources
from typing import Any

from hil.analysis.diagnosis import Diagnosis
from reports import style
from reports.diagnosis_content import Part, headline, lead, parts
from reports.pdf import _font_directory, _known_characters, _spelled_out
from reports.svg_figure import svg_figure

_TONES = {"named": "pass", "none": "pass", "unknown": "error"}


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
        headline=headline(found),
        tone=_TONES[found.verdict],
        lead=lead(found),
        notes=found.notes,
        parts=[_with_pictures(part) for part in parts(found)],
        light=style.css_variables("light"),
        dark=style.css_variables("dark"),
        css=resources.files("reports").joinpath("templates/report.css").read_text(encoding="utf-8"),
    )


def diagnosis_pdf(found: Diagnosis, title: str) -> bytes:
    """The same on paper: PDF/A-2b. Every text reaches Typst as data."""
    import typst

    data: dict[str, Any] = {
        "title": title,
        "headline": headline(found),
        "tone": _TONES[found.verdict],
        "lead": lead(found),
        "notes": list(found.notes),
        "parts": [_as_data(part) for part in parts(found)],
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
