"""The report for signing: PDF/A-2a and PDF/UA-1 by Typst, from the same content as the page for the screen.

Every text from a file reaches Typst as JSON data and is never parsed as markup.
"""

from __future__ import annotations

import dataclasses
import datetime
import json
import logging
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from hil.core.files import write_atomically
from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import style
from reports.content import Content, content
from reports.figure import Figure
from reports.labels import pieces
from reports.report_identity import Claim, keywords
from reports.svg_figure import svg_figure

logger = logging.getLogger(__name__)

_MOST_EVENTS = 200


def write_pdf(recording: Recording, result: RunResult | None, path: Path) -> Path:
    """Write the PDF/A report, whole or not at all; `result` is None for a recording without a plan.

    Raises:
        BadInputError: `path` cannot be written.
    """
    write_atomically(path, pdf_bytes(content(recording, result)))
    return path


def pdf_bytes(report: Content) -> bytes:
    """The PDF; the same content gives the same bytes where the same fonts are at hand."""
    data = _data(report)
    known = _known_characters()
    if all(map(known, _strings(data))):
        return _compiled(data, report.started_at, system_fonts=False)
    import typst

    logger.info("the report has characters that its own fonts lack: system fonts are tried")
    try:  # a script that the own fonts lack: the system may have it
        return _compiled(data, report.started_at, system_fonts=True)
    except (typst.TypstError, UnicodeError) as error:  # PDF/A refuses a character without a glyph
        logger.info("characters are spelled out: %s", error)
        return _compiled(_spelled_out(data, known), report.started_at, system_fonts=False)


def _compiled(data: dict[str, Any], started_at: str, *, system_fonts: bool) -> bytes:
    import typst

    template = resources.files("reports").joinpath("templates/report.typ").read_bytes()
    pdf = typst.compile(
        template,
        font_paths=typst.Fonts(include_system_fonts=system_fonts, font_paths=[str(_font_directory())]),
        sys_inputs={"report": json.dumps(data, ensure_ascii=False)},
        pdf_standards=["a-2a", "ua-1"],
        timestamp=_timestamp(started_at),
    )
    return bytes(pdf)


def _data(report: Content) -> dict[str, Any]:
    data = dataclasses.asdict(dataclasses.replace(report, sections=(), summary=None))
    if report.summary is not None:
        drawn = report.summary.figure and _figure(report.summary.figure)
        rows = [dataclasses.asdict(row) for row in report.summary.rows]
        data["summary"] = {"rows": rows, "further": report.summary.further, "figure": drawn}
    if report.criteria is not None:
        data["definitions"] = [pieces(text) for text in report.criteria.definitions]
    data["unmet"] = [dataclasses.asdict(row) for row in report.unmet]
    data["events_left_out"] = max(0, len(report.events) - _MOST_EVENTS)
    data["events"] = data["events"][:_MOST_EVENTS]
    data["sections"] = [
        {
            "title": section.title,
            "text": section.text,
            "notes": [pieces(note) for note in section.notes],
            "figures": [_figure(figure) for figure in section.figures],
        }
        for section in report.sections
    ]
    data["keywords"] = keywords(Claim(report.source, report.sha256, report.samples_sha256))
    data["colors"] = {name: tone.light for name, tone in style.SURFACE.items()}
    data["width_mm"] = style.PAPER_WIDTH_MM
    return data


def _figure(figure: Figure) -> dict[str, Any]:
    return {
        "svg": svg_figure(figure).decode(),
        "title": figure.title._asdict(),
        "caption": figure.caption,
        "alt": figure.alternative_text(),
        "wide": figure.wide,
    }


def _timestamp(started_at: str) -> datetime.datetime:
    """The document's date: the start of the run, so that a report made again is the same document."""
    try:
        moment = datetime.datetime.fromisoformat(started_at).replace(microsecond=0)  # as PDF counts
    except ValueError:
        return datetime.datetime.now(datetime.UTC).replace(microsecond=0)
    return moment if moment.tzinfo else moment.replace(tzinfo=datetime.UTC)


def _font_directory() -> Path:
    """DejaVu, which comes with Matplotlib, so that words and figures share a typeface on every machine."""
    import matplotlib as mpl

    return Path(mpl.get_data_path()) / "fonts" / "ttf"


def _known_characters() -> Callable[[str], bool]:
    from matplotlib.ft2font import FT2Font

    glyphs = FT2Font(_font_directory() / "DejaVuSans.ttf").get_charmap().keys() | {ord("\n")}
    return lambda text: (text.isascii() and text.isprintable()) or all(ord(c) in glyphs for c in text)


def _strings(value: object) -> list[str]:
    if isinstance(value, str):
        return [value]
    if isinstance(value, dict):
        return [text for key, item in value.items() if key != "svg" for text in _strings(item)]
    if isinstance(value, list | tuple):
        return [text for item in value for text in _strings(item)]
    return []


def _spelled_out(value: Any, known: Callable[[str], bool]) -> Any:
    """The data with each character that has no glyph written as its code point, such as ‹U+8A66›."""
    if isinstance(value, str):
        return value if known(value) else "".join(c if known(c) else f"‹U+{ord(c):04X}›" for c in value)
    if isinstance(value, dict):
        return {key: item if key == "svg" else _spelled_out(item, known) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_spelled_out(item, known) for item in value]
    return value
