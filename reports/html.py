"""The report for the screen: one HTML file with interactive figures that asks no network for anything."""

from __future__ import annotations

import html
import re
from importlib import resources
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import open_regular, write_atomically
from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import style
from reports.content import Content, content
from reports.labels import sentence_html
from reports.plotly_figure import json_in_script, plotly_figure, plotly_script

_LARGEST_INPUT_FILE = 200_000


def write_html(recording: Recording, result: RunResult | None, path: Path) -> Path:
    """Write the HTML report, whole or not at all; `result` is None for a recording without a plan.

    Raises:
        BadInputError: `path` cannot be written.
    """
    write_atomically(path, html_text(content(recording, result), input_texts(recording)))
    return path


def html_text(report: Content, texts: list[tuple[str, str]]) -> str:
    """The page; `texts` are the names and texts of the input files to show in it."""
    import jinja2  # slow to import; only this form needs it
    from markupsafe import Markup

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("reports"),
        autoescape=True,
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    first = [report.summary.figure] if report.summary and report.summary.figure else []
    drawn = [*first, *(figure for section in report.sections for figure in section.figures)]
    figures = {figure.id: plotly_figure(figure) for figure in drawn}
    environment.filters["sentence"] = lambda text: Markup(sentence_html(text))
    page = environment.get_template("report.html.j2").render(
        c=report,
        contents=_contents(report, bool(texts)),
        texts=texts,
        figures=json_in_script(figures) if figures else "",
        plotly=plotly_script() if figures else "",
        light=style.css_variables("light"),
        dark=style.css_variables("dark"),
        css=_template("report.css"),
        js=_template("report.js"),
    )
    return page.encode("utf-8", "replace").decode()  # half a surrogate pair from a broken event


def recording_named_in(page: Path) -> str:
    """File name of the recording that an existing report was made from; '' if it does not say."""
    try:
        with open_regular(page) as file:
            head = file.read(4096).decode("utf-8", "replace")
    except (BadInputError, OSError):
        return ""
    found = re.search(r'<meta name="recording" content="([^"]*)">', head)
    return html.unescape(found[1]) if found else ""


def input_texts(recording: Recording) -> list[tuple[str, str]]:
    """Attachments that are text of a readable length."""
    found = []
    for name, attached in recording.attachments.items():
        if len(attached) > _LARGEST_INPUT_FILE:
            continue
        try:
            found.append((name, attached.decode()))
        except UnicodeDecodeError:
            continue
    return found


def _contents(report: Content, has_texts: bool) -> list[tuple[str, str]]:
    entries = [
        ("verdict", "Summary" if report.banner.tone == "none" else "Verdict", True),
        ("summary", "Margins", report.summary is not None),
        ("notes", "Notes", bool(report.notes)),
        ("criteria", "Criteria", report.criteria is not None),
        ("statistics", "Statistics", bool(report.channels)),
        *((section.id, section.title, True) for section in report.sections),
        ("run", "Recording" if report.banner.tone == "none" else "Run and device", True),
        ("provenance", "Provenance", True),
        ("segments", "Segments", bool(report.segments)),
        ("events", "Events", bool(report.events)),
        ("inputs", "Input files", has_texts),
    ]
    return [(anchor, name) for anchor, name, present in entries if present]


def _template(name: str) -> str:
    return resources.files("reports").joinpath("templates", name).read_text(encoding="utf-8")
